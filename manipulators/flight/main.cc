#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>

#include "manipulators/flight/course.h"
#include "manipulators/kit/manipulator.h"

namespace {

constexpr std::string_view declaration = R"~(
type flier extends node "flies through points on a smooth way: a bird, or a stand for a camera; +Z is forward"
field flier.way vec3[] m "the points, in the frame of its parent"
field flier.times real[] s "when it is there; before and after it stands still"
field flier.lean real = 1 in 0 3 "into turns: 1 as the forces have it, 0 upright"
field flier.beat real Hz = 2.8 in 0 50 "of its wings"
field flier.stroke real rad = 0.65 in 0 1.5 "of its wings, when it climbs; it glides when it sinks"
field flier.status word = no_way of no_way waiting flying arrived
field flier.reason text "one sentence, when it has no way"
field flier.speed real m/s
type wing extends node "beats about its own z, as the flier that it is below says; its tip is along its x"
field wing.side int = 1 in -1 1 "1: the left one, 0: it does not beat, -1: the right one"
field wing.lag real rad = 0 in 0 6.3 "how far it is behind the beat: of the outer wing"
field wing.share real = 1 in 0 2 "of the stroke"
field wing.fold real rad = 0 in -3.2 3.2 "backwards about its y, when it has arrived"
writes flier.position flier.orientation flier.status flier.reason flier.speed
writes wing.orientation
)~";

using objdb::Object;

objdb::Quat quat_of(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

class Flight {
 public:
  Flight() : me_("flight", declaration) {
    // all that it knows it has been told
    me_.on_checkpoint([] {});
    me_.on_tick([this](const kit::Tick& tick) {
      for (const Object* flier : me_.objects("flier")) fly(*flier, tick.time);
      for (const Object* wing : me_.objects("wing")) beat(*wing, tick.time);
    });
  }
  int run() { return me_.run(); }

 private:
  static flight::Course course_of(const std::vector<double>& way, const std::vector<double>& times) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i + 2 < way.size(); i += 3) points.emplace_back(way[i], way[i + 1], way[i + 2]);
    return {std::move(points), times};
  }

  void fly(const Object& flier, double time) {
    const std::vector<double> way = me_.get<objdb::Numbers>(flier, "way").vector();
    const std::vector<double> times = me_.get<objdb::Numbers>(flier, "times").vector();
    Known& known = known_[flier.id];
    if (known.way != way || known.times != times) known = {way, times, course_of(way, times), {}};
    me_.set(flier, "reason", known.course.problem());
    if (known.course.empty()) {
      me_.set_word(flier, "status", "no_way");
      return;
    }
    known.state = known.course.at(time);
    const auto& q = me_.get<objdb::Quat>(flier, "orientation");
    const Eigen::Quaterniond before(q[0], q[1], q[2], q[3]);
    const Eigen::Quaterniond now = flight::attitude(known.state, me_.get<double>(flier, "lean"), before);
    me_.set(flier, "position", objdb::Vec3{known.state.p.x(), known.state.p.y(), known.state.p.z()});
    me_.set(flier, "orientation", quat_of(now));
    me_.set(flier, "speed", known.state.v.norm());
    me_.set_word(flier, "status",
                 time < known.course.start() ? "waiting"
                 : time < known.course.end() ? "flying"
                                             : "arrived");
  }

  void beat(const Object& wing, double time) {
    const objdb::Database& world = me_.world();
    const objdb::Type* type = world.schema().find("flier");
    const Object* flier = &wing;
    while (flier && !flier->type->is(*type)) flier = world.object(world.scene().parent_of(*flier));
    const auto side = static_cast<double>(me_.get<std::int64_t>(wing, "side"));
    if (!flier || side == 0) return;
    const Known& known = known_[flier->id];
    const double phase = 2 * std::numbers::pi * me_.get<double>(*flier, "beat") * time - me_.get<double>(wing, "lag");
    // standing still is a glide: wings are held out
    const double climb = known.state.v.norm() > 0 ? known.state.v.y() : -1;
    const double angle =
        me_.get<double>(wing, "share") * flight::wing_angle(phase, me_.get<double>(*flier, "stroke"), climb);
    // half a second after it has arrived the wings lie against the body
    const double rest = known.course.empty() ? 0 : std::clamp((time - known.course.end()) / 0.5, 0.0, 1.0);
    const double folded = rest * rest * (3 - 2 * rest);
    me_.set(wing, "orientation",
            quat_of(Eigen::AngleAxisd(side * folded * me_.get<double>(wing, "fold"), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(side * (1 - folded) * angle, Eigen::Vector3d::UnitZ())));
  }

  struct Known {
    std::vector<double> way, times;
    flight::Course course;
    flight::Course::State state;
  };
  kit::Manipulator me_;
  std::map<objdb::ObjectId, Known> known_;
};

}  // namespace

int main(int argc, char**) {
  if (argc > 1) {
    std::fprintf(stderr, "usage: flight    a manipulator: the dialog manager starts it (start flight)\n");
    return 2;
  }
  return Flight().run();
}
