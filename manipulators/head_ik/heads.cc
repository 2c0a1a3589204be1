#include "manipulators/head_ik/heads.h"

#include <time.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using objdb::Object;
using objdb::Result;
using objdb::Vec3;

constexpr std::string_view declarations = R"neck(
  type neck extends node "turns a head towards what it looks at; the joints between root and tip are its levels"
  field neck.root ref:node "the thorax: what the neck stands on"
  field neck.tip ref:node "the head"
  field neck.sight vec3 m = 0 0.03 0.085 "the point between the eyes, in the frame of tip"
  field neck.target ref:node "what it looks at; look sets it"
  field neck.point vec3 m "where it looks without a target, in the world"
  field neck.active bool = false "false: it looks straight ahead"
  field neck.aim word = direction of direction normal "look at the target, or against its surface normal"
  field neck.normal vec3 = 0 0 1 "the surface normal, in the frame of the target"
  field neck.method word = swing_twist of swing_twist paper_zyz "how orientation and limits are found; paper_zyz is the printed rule"
  field neck.share word = human of human full eyes "how much of a gaze the head takes: as people do, all, or what gaze_yaw and gaze_pitch say"
  field neck.gaze_yaw real rad = 0 in -4 4 "where the head is to look with share eyes: to the left, in the frame of root"
  field neck.gaze_pitch real rad = 0 in -2 2 "likewise: above the horizon"
  field neck.share_start real rad = 0.3490658503988659 in 0 2 "share human: the head stays for gaze shifts below (20 deg; Freedman and Sparks 1997)"
  field neck.share_yaw real = 0.79 in 0 1 "share human: its part of what goes beyond, sideways (joins the end points of Freedman and Sparks 1997)"
  field neck.share_pitch real = 0.26 in 0 1 "likewise up and down (a third, after Tweed's gains 0.9 and 0.3)"
  field neck.eye_reach real rad = 0.6108652381980153 in 0 2 "share human: the eyes are never left more than this (35 deg; Freedman and Sparks 1997)"
  field neck.roll real = 1 in 0 1 "Donders' law: 1 Fick, the eyes stay level; 0 Listing, the shortest way"
  field neck.eye_latency real s = 0.2 in 0 2 "from a new target to the start of the eyes; the head follows by its own lag"
  field neck.lag real s = 0.0677 in 0.001 5 "time constant of each of three lags; peak speed = 0.27 / lag * amplitude"
  field neck.rate real rad/s = 6.981317007977318 in 0.001 100 "the most that flexion, lateral or axial total changes (400 deg/s)"
  field neck.status word = idle of idle waiting moving reached limited too_near no_target no_chain
  field neck.reason text "one sentence, when there is something to say"
  field neck.limits word = none of none tilt axial both "which limit of the neck the goal lies on"
  field neck.gaze_error real rad "look axis to target: what is left for the eyes"
  field neck.head_error real rad "look axis to where it will be"
  field neck.alpha real rad "the head in the neck's frame, Rz(alpha) Ry(beta) Rz(gamma)"
  field neck.beta real rad
  field neck.gamma real rad
  field neck.lower_neck vec3 rad "flexion, lateral, axial of the levels below the top two"
  field neck.upper_neck vec3 rad "likewise of the top two (the top one of two)"
  field neck.iterations int "Newton steps of the last tick"
  field neck.elapsed real s measured "processor time of the last tick"
  field neck.memory real[] private "state of the motion"
  field neck.remembered ref:node private "what it looked at"
  verb look "FIGURE TARGET|X Y Z|away" "Turns the head of a figure towards a node, a point of the world, or straight ahead."
  reads node.parent node.position node.orientation delayed
  reads joint.dh joint.angle joint.lower joint.upper joint.rest delayed
  writes joint.angle
  writes neck.target neck.point neck.active neck.status neck.reason neck.limits neck.gaze_error neck.head_error
  writes neck.alpha neck.beta neck.gamma neck.lower_neck neck.upper_neck neck.iterations
)neck";

double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Vector3d vector_of(const Vec3& p) { return {p[0], p[1], p[2]}; }
Vec3 triple(const Vector3d& v) { return {v[0], v[1], v[2]}; }

Matrix3d rotation_of(const objdb::scene::Transform& x) {
  Matrix3d R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = x.R[i][j];
  return R;
}

std::string degrees(double angle) {
  char text[32];
  // no minus sign on what rounds to zero
  const double tenths = std::round(angle * 1800 / M_PI);
  std::snprintf(text, sizeof text, "%.1f deg", tenths == 0 ? 0 : tenths / 10);
  return text;
}

}  // namespace

Heads::Heads() : me_("head_ik", declarations) {
  me_.on_tick([this](const kit::Tick& now) { tick(now); });
  me_.on_verb("look", [this](objdb::Words words) { return look(words); });
  me_.on_checkpoint([this] { remember(); });
}

// -- the verb

const Object* Heads::neck_of(const Object& figure) const {
  for (const Object* neck : me_.objects("neck"))
    if (neck == &figure || neck->path.starts_with(figure.path + "/")) return neck;
  return nullptr;
}

Result<std::string> Heads::look(objdb::Words words) {
  if (words.size() != 2 && words.size() != 4)
    return objdb::Error{objdb::ErrorKind::syntax, "expected look FIGURE TARGET|X Y Z|away",
                        words.empty() ? 1 : words.back().column};
  const Result<const Object*> figure = me_.object(words[0]);
  if (!figure) return figure.error();
  const Object* neck = neck_of(**figure);
  if (neck == nullptr)
    return objdb::Error{objdb::ErrorKind::unknown, (*figure)->path + " has no neck: no object of type neck below it",
                        words[0].column};
  std::int64_t target = 0;
  Vec3 point{0, 0, 0};
  const bool away = words.size() == 2 && words[1].text == "away" && !words[1].quoted;
  if (words.size() == 4) {
    const auto field = neck->type->field(neck->type->find("point"));
    const Result<objdb::Value> value = objdb::parse_value(field, words.subspan(1), me_.world());
    if (!value) return value.error();
    point = std::get<Vec3>(*value);
  } else if (!away) {
    const Result<const Object*> found = me_.object(words[1], "node");
    if (!found) return found.error();
    target = (*found)->id;
  }
  me_.set(*neck, "target", target);
  if (words.size() == 4) me_.set(*neck, "point", point);
  me_.set(*neck, "active", std::int64_t{!away});
  // a target that is dropped by a new command has not gone
  heads_[neck->id].target = static_cast<objdb::ObjectId>(target);
  heads_[neck->id].commanded = true;
  return std::string();
}

// -- a tick

void Heads::tick(const kit::Tick& now) {
  std::erase_if(heads_, [&](const auto& entry) { return me_.world().object(entry.first) == nullptr; });
  for (const Object* neck : me_.objects("neck")) {
    const double start = processor_time();
    move(*neck, heads_[neck->id], now);
    me_.set(*neck, "elapsed", processor_time() - start);
  }
}

bool Heads::find(const Object& object, Head& head) {
  const Object *root = me_.target(object, "root"), *tip = me_.target(object, "tip");
  if (root == nullptr || tip == nullptr) {
    head.chain.reset();
    head.fingerprint.clear();
    head.fault = root == nullptr ? "root names no node" : "tip names no node";
    return false;
  }
  std::vector<double> fresh = fingerprint(me_.world(), *root, *tip);
  if (!fresh.empty() && fresh == head.fingerprint) return head.chain.has_value();
  head.fingerprint = std::move(fresh);
  auto found = find_chain(me_.world(), *root, *tip);
  if (auto* sentence = std::get_if<std::string>(&found)) {
    head.chain.reset();
    head.fault = std::move(*sentence);
  } else {
    head.chain = std::move(std::get<Chain>(found));
  }
  return head.chain.has_value();
}

Settings Heads::settings(const Object& object, const Head& head) const {
  const auto real = [&](std::string_view field) { return me_.get<double>(object, field); };
  Settings settings;
  settings.method = static_cast<Method>(me_.get<std::int64_t>(object, "method"));
  settings.part = static_cast<Part>(me_.get<std::int64_t>(object, "share"));
  settings.share = {real("share_start"), real("share_yaw"), real("share_pitch"), real("eye_reach")};
  settings.pace = {real("lag"), real("rate")};
  settings.roll = real("roll");
  settings.eye_latency = real("eye_latency");
  settings.sight = vector_of(me_.get<Vec3>(object, "sight"));
  settings.head_at_rest = head.chain->R_NH;
  // the wish is said in the root's frame
  const Vector3d wish = head.chain->R_RN.transpose() * direction({real("gaze_yaw"), real("gaze_pitch")});
  settings.wish = gaze(wish);
  return settings;
}

Sight Heads::sight(const Object& object, const Head& head) {
  Sight seen;
  if (!head.active) return seen;
  const Object& root = *me_.target(object, "root");
  const objdb::scene::Transform& X_WR = me_.world().scene().world(root);
  const Matrix3d R_WN = rotation_of(X_WR) * head.chain->R_RN;
  const Vector3d p_WN = vector_of(X_WR.p) + rotation_of(X_WR) * head.chain->p_RN;
  const Object* target = me_.target(object, "target");
  Vector3d place = vector_of(me_.get<Vec3>(object, "point"));
  seen.kind = Sight::point;
  if (target != nullptr) {
    const objdb::scene::Transform& X_WT = me_.world().scene().world(*target);
    place = vector_of(X_WT.p);
    const Vector3d normal = rotation_of(X_WT) * vector_of(me_.get<Vec3>(object, "normal"));
    if (me_.word(object, "aim") == "normal" && normal.norm() > 1e-9) {
      seen.kind = Sight::orientation;
      seen.normal = R_WN.transpose() * normal.normalized();
    }
  }
  seen.place = R_WN.transpose() * (place - p_WN);
  return seen;
}

// takes note of what is looked at; true when it is something else than in the last tick
bool Heads::retargeted(const Object& object, Head& head) {
  const bool active = me_.get<std::int64_t>(object, "active") != 0;
  const auto target = static_cast<objdb::ObjectId>(me_.get<std::int64_t>(object, "target"));
  const Vector3d point = vector_of(me_.get<Vec3>(object, "point"));
  const bool changed = head.commanded || active != head.active || (active && target != head.target) ||
                       (active && target == 0 && point != head.point);
  head.commanded = false;
  head.active = active;
  head.target = target;
  head.point = point;
  return changed && head.known;
}

void Heads::start_from_joints(Head& head, const kit::Tick& now) {
  const Neck& neck = head.chain->neck;
  Vector3d total(0, 0, 0);
  for (int j = 0; j < 3 * neck.size(); ++j) {
    const Object& joint = *me_.world().object(head.chain->joints[j]);
    total[j % 3] += me_.get<double>(joint, "angle") - neck.levels()[j / 3].rest[j % 3];
  }
  Control::State& state = head.control.state;
  state = {};
  state.goal = state.motion.paced = neck.clamped(total);
  state.motion.lag.fill(state.goal);
  state.steps = static_cast<std::int64_t>(std::floor((now.time - now.step) / Control::grid + 1e-6));
}

void Heads::move(const Object& object, Head& head, const kit::Tick& now) {
  if (!find(object, head)) {
    me_.set_word(object, "status", "no_chain");
    me_.set(object, "reason", head.fault);
    return;
  }
  if (!head.known) recall(object, head);
  // a target that was deleted is not looked for at the point of an earlier command
  const bool gone = head.known && head.target != 0 && !head.commanded && me_.target(object, "target") == nullptr &&
                    me_.get<std::int64_t>(object, "active") != 0;
  if (gone) me_.set(object, "active", std::int64_t{0});
  // a fresh head, or one whose time was turned back, starts where its joints are
  const double away = (now.time - now.step) - static_cast<double>(head.control.state.steps) * Control::grid;
  if (!head.known || std::abs(away) > 2 * Control::grid) start_from_joints(head, now);
  head.known = true;

  const bool changed = retargeted(object, head);
  const Settings how = settings(object, head);
  const Control::Report report =
      head.control.tick(head.chain->neck, how, now.time, now.step, sight(object, head), changed);

  double angles[3 * Neck::most_levels];
  head.chain->neck.spread(report.posture, angles);
  for (std::size_t j = 0; j < head.chain->joints.size(); ++j)
    me_.set(*me_.world().object(head.chain->joints[j]), "angle", angles[j]);
  this->report(object, head, report);
  head.gone = gone || (head.gone && !head.active && !changed);
  if (head.gone) {
    me_.set_word(object, "status", "no_target");
    me_.set(object, "reason", std::string("what it looked at is gone"));
  }
}

// -- what it tells

std::string Heads::reason(const Head& head, const Control::Report& report) const {
  if (report.status == Status::waiting)
    return "starts to move at " + objdb::number(std::round(1e3 * head.control.state.onset) / 1e3) + " s";
  if (report.status == Status::too_near) return "the target is within 2 cm of the point between the eyes";
  if (report.limit == Limit::none) return "";
  const Vector3d& goal = head.control.state.goal;
  std::string sentence;
  if (report.limit != Limit::tilt) sentence = "turning ends at " + degrees(goal[axial]);
  if (report.limit == Limit::both) sentence += ", ";
  if (report.limit != Limit::axial)
    sentence += "leaning ends at flexion " + degrees(goal[flexion]) + " with lateral " + degrees(goal[lateral]);
  return sentence;
}

void Heads::report(const Object& object, const Head& head, const Control::Report& report) {
  const Neck& neck = head.chain->neck;
  me_.set_word(object, "status", name_of(report.status));
  me_.set(object, "reason", reason(head, report));
  me_.set_word(object, "limits", name_of(report.limit));
  me_.set(object, "gaze_error", report.gaze_error);
  me_.set(object, "head_error", report.head_error);
  const Zyz angles = zyz(neck.rotation(report.posture) * head.chain->R_NH);
  me_.set(object, "alpha", angles.alpha);
  me_.set(object, "beta", angles.beta);
  me_.set(object, "gamma", angles.gamma);
  const auto [lower, upper] = neck.groups(report.posture);
  me_.set(object, "lower_neck", triple(lower));
  me_.set(object, "upper_neck", triple(upper));
  me_.set(object, "iterations", std::int64_t{report.iterations});
}

// -- checkpoints: the state as numbers in a fixed order

namespace {

// visits every number of the state; reading and writing go the same way
template <class State, class Visit>
void visit_numbers(State& s, Visit visit) {
  const auto vector = [&](auto& v) {
    for (int i = 0; i < 3; ++i) visit(v[i]);
  };
  visit(s.steps);
  vector(s.motion.paced);
  for (auto& lag : s.motion.lag) vector(lag);
  vector(s.goal);
  visit(s.onset);
  visit(s.side);
  visit(s.seen.kind);
  vector(s.seen.place);
  vector(s.seen.normal);
  visit(s.limit);
  visit(s.too_near);
}

}  // namespace

void Heads::remember() {
  for (auto& [id, head] : heads_) {
    const Object* object = me_.world().object(id);
    if (object == nullptr || !head.known) continue;
    std::vector<double> numbers{static_cast<double>(head.active), static_cast<double>(head.gone), head.point[0],
                                head.point[1], head.point[2]};
    visit_numbers(head.control.state, [&](const auto& number) { numbers.push_back(static_cast<double>(number)); });
    me_.set(*object, "memory", numbers);
    me_.set(*object, "remembered", static_cast<std::int64_t>(me_.world().object(head.target) ? head.target : 0));
  }
}

void Heads::recall(const Object& object, Head& head) {
  const std::span<const double> numbers = me_.numbers(object, "memory");
  std::size_t count = 5;
  Control::State state;
  visit_numbers(state, [&](const auto&) { ++count; });
  if (numbers.size() != count) return;
  head.active = numbers[0] != 0;
  head.gone = numbers[1] != 0;
  head.point = {numbers[2], numbers[3], numbers[4]};
  head.target = static_cast<objdb::ObjectId>(me_.get<std::int64_t>(object, "remembered"));
  auto next = numbers.begin() + 5;
  visit_numbers(state, [&](auto& number) { number = static_cast<std::decay_t<decltype(number)>>(*next++); });
  head.control.state = state;
  head.known = true;
}

}  // namespace head
