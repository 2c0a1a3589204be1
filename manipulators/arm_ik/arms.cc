#include "manipulators/arm_ik/arms.h"

#include "manipulators/arm_ik/cpu_clock.h"
#include "manipulators/arm_ik/mass.h"

namespace arm_ik {

namespace {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Object;
using objdb::Result;
using objdb::Vec3;

constexpr std::string_view declarations = R"~(
  type arm extends node "a limb that reaches: the joints that carry tip below root"
  field arm.root ref:node "what the limb stands on; without one, all joints above tip"
  field arm.tip ref:node "what it brings to the target: a hand, a foot"
  field arm.target ref:node "where it reaches; reach sets it"
  field arm.task word = position of position pose "bring the tip to the target's place, or to its place and orientation"
  field arm.method word = auto of auto limb rhythm full reach polish clamped "auto: the cheapest that meets task and tolerance"
  field arm.tolerance real m = 1e-5 in 1e-15 10 "distance at which the target is reached"
  field arm.rotation_tolerance real rad = 1e-4 in 1e-15 3.2 "angle at which its orientation is"
  field arm.rate real rad/s = 5 in 1e-3 1e3 "the most that a joint moves"
  field arm.status word = idle of idle reached moving limited unreachable budget incomplete "how it stands"
  field arm.reason text "what keeps it from the target"
  field arm.chosen word = auto of auto limb rhythm full reach polish clamped "the method that gave the posture"
  field arm.active_limits ref:joint[] "joints whose limits hold it off the target"
  field arm.position_error real m "tip to target"
  field arm.rotation_error real rad "likewise; 0 for task position"
  field arm.iterations int "linear solves of the last tick"
  field arm.elapsed real s measured "processor time of the last tick"
  field arm.freedoms int "joints between root and tip"
  field arm.shoulder_plane real rad "of a human arm, by the ISB's convention: plane of elevation"
  field arm.shoulder_elevation real rad "likewise: elevation, negative when raised"
  field arm.shoulder_rotation real rad "likewise: axial rotation, inwards positive"
  field arm.elbow_flexion real rad "likewise"
  field arm.elbow_carrying real rad "likewise"
  field arm.forearm_pronation real rad "likewise"
  field arm.memory real[] private "state of the motion"
  field arm.remembered ref:node private "what it reached for"
  type segment extends node "a part of a body with its mass, between two ends in its own frame"
  field segment.kind word = forearm of head trunk upper_trunk middle_trunk lower_trunk upper_arm forearm hand thigh shank foot "row of de Leva's table (1996)"
  field segment.sex word = male of male female
  field segment.body_mass real kg = 73 in 0 1000 "of the whole person"
  field segment.from vec3 m "end nearer to the trunk; vertex, top of the breastbone, heel of head, trunk, foot"
  field segment.to vec3 m = 0 -0.25 0 "the other end"
  field segment.forward vec3 = 0 0 1 "where the front is"
  field segment.mass real kg
  field segment.center vec3 m "centre of mass"
  field segment.inertia real[6] kg*m^2 "about the centre of mass: xx yy zz xy xz yz"
  verb reach "ARM TARGET|none" "Makes an arm (or leg) reach for a node and keep following it, or stop."
  reads node.parent node.position node.orientation delayed
  reads joint.dh joint.angle joint.lower joint.upper joint.rest delayed
  reads segment
  writes joint.angle segment.mass segment.center segment.inertia
  writes arm.target arm.status arm.reason arm.chosen arm.active_limits arm.position_error arm.rotation_error
  writes arm.iterations arm.elapsed arm.freedoms arm.shoulder_plane arm.shoulder_elevation arm.shoulder_rotation
  writes arm.elbow_flexion arm.elbow_carrying arm.forearm_pronation arm.memory arm.remembered
)~";

kinematics::Pose pose_of(const objdb::scene::Transform& x) {
  kinematics::Pose out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.R(row, column) = x.R[row][column];
    out.p[row] = x.p[row];
  }
  return out;
}

}  // namespace

Arms::Arms() : me_("arm_ik", declarations) {
  me_.on_tick([this](const kit::Tick& now) { tick(now); });
  me_.on_verb("reach", [this](objdb::Words words) { return reach(words); });
  me_.on_checkpoint([this] { remember(); });
}

Result<std::string> Arms::reach(objdb::Words words) {
  if (words.size() != 2) {
    return Error{ErrorKind::syntax, "expected reach ARM TARGET|none", words.empty() ? 1 : words.back().column};
  }
  const Result<const Object*> arm = me_.object(words[0], "arm");
  if (!arm) return arm.error();
  std::int64_t target = 0;
  if (words[1].text != "none" || words[1].quoted) {
    const Result<const Object*> found = me_.object(words[1], "node");
    if (!found) return found.error();
    target = (*found)->id;
  }
  me_.set(**arm, "target", target);
  limbs_[(*arm)->id].lost = false;
  return std::string();
}

// cheap, so done every tick; what has not changed is not said again
void Arms::weigh(const Object& segment) {
  const auto vector = [&](std::string_view field) {
    const Vec3& v = me_.get<Vec3>(segment, field);
    return Eigen::Vector3d(v[0], v[1], v[2]);
  };
  const MassProperties body =
      mass_properties(static_cast<Segment>(me_.get<std::int64_t>(segment, "kind")),
                      static_cast<Sex>(me_.get<std::int64_t>(segment, "sex")), me_.get<double>(segment, "body_mass"),
                      vector("from"), vector("to"), vector("forward"));
  const Eigen::Matrix3d& I = body.inertia;
  me_.set(segment, "mass", body.mass);
  me_.set(segment, "center", Vec3{body.center.x(), body.center.y(), body.center.z()});
  me_.set(segment, "inertia", std::vector<double>{I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
}

void Arms::tick(const kit::Tick& now) {
  for (const Object* segment : me_.objects("segment")) weigh(*segment);
  std::erase_if(limbs_, [&](const auto& entry) { return me_.world().object(entry.first) == nullptr; });
  for (const Object* arm : me_.objects("arm")) {
    const double start = cpu_seconds();
    move(*arm, limbs_[arm->id], now);
    me_.set(*arm, "elapsed", cpu_seconds() - start);
  }
}

// looks the chain up again when anything that it is made of has changed
bool Arms::find(const Object& arm, Limb& limb) {
  const Object *root = me_.target(arm, "root"), *tip = me_.target(arm, "tip");
  if (tip == nullptr) {
    limb.fault = "tip names no node";
    limb.fingerprint.clear();
    limb.reacher.reset();
    return false;
  }
  std::vector<double> fresh = fingerprint(me_.world(), root, *tip);
  if (!fresh.empty() && fresh == limb.fingerprint) return limb.reacher != nullptr;
  limb.fingerprint = std::move(fresh);
  limb.reacher.reset();
  auto found = find_chain(me_.world(), root, *tip);
  if (auto* sentence = std::get_if<std::string>(&found)) {
    limb.fault = std::move(*sentence);
    return false;
  }
  FigureChain& chain = std::get<FigureChain>(found);
  limb.joints = std::move(chain.joints);
  limb.reacher = std::make_unique<Reacher>(chain.chain);
  me_.set(arm, "freedoms", static_cast<std::int64_t>(limb.joints.size()));
  return true;
}

void Arms::stand(const Object& arm, std::string_view status, const std::string& reason) {
  me_.set_word(arm, "status", status);
  me_.set(arm, "reason", reason);
  me_.set(arm, "active_limits", std::vector<std::int64_t>());
  me_.set(arm, "position_error", 0.0);
  me_.set(arm, "rotation_error", 0.0);
  me_.set(arm, "iterations", std::int64_t{0});
}

void Arms::move(const Object& arm, Limb& limb, const kit::Tick& now) {
  if (!find(arm, limb)) {
    limb.known = false;
    stand(arm, "incomplete", limb.fault);
    return;
  }
  if (!limb.known) recall(arm, limb);
  std::vector<double> q;
  for (const objdb::ObjectId joint : limb.joints) q.push_back(me_.get<double>(*me_.world().object(joint), "angle"));

  const Object* target = me_.target(arm, "target");
  // what it reached for was deleted, and nobody said otherwise
  limb.lost = target == nullptr &&
              (limb.lost || (limb.known && limb.target != 0 && me_.world().object(limb.target) == nullptr));
  const objdb::ObjectId id = target == nullptr ? 0 : target->id;
  const bool fresh = !limb.known || id != limb.target;
  limb.known = true;
  limb.target = id;
  if (target == nullptr) {
    stand(arm, "idle", limb.lost ? "what it reached for is gone" : "");
    report_anatomy(arm, limb, q);
    return;
  }

  std::string why_not;
  const auto real = [&](std::string_view field) { return me_.get<double>(arm, field); };
  Method method = Method::automatic;
  method_named(me_.word(arm, "method"), method);
  if (!limb.reacher->offers(method, why_not)) {
    stand(arm, "incomplete", "method " + std::string(name_of(method)) + " " + why_not);
    return;
  }
  // the goal in the frame that the chain stands in
  const Object* root = me_.target(arm, "root");
  kinematics::Pose goal = pose_of(me_.world().scene().world(*target));
  if (root != nullptr) goal = kinematics::inverse(pose_of(me_.world().scene().world(*root))) * goal;
  Reacher::Order order(Goal(goal, me_.word(arm, "task") == "pose"));
  order.method = method;
  order.solve.position_tolerance = real("tolerance");
  order.solve.rotation_tolerance = real("rotation_tolerance");
  order.rate = real("rate");
  order.fresh = fresh;
  const Solution solution = limb.reacher->tick(order, now.step, q);
  for (std::size_t i = 0; i < q.size(); ++i) me_.set(*me_.world().object(limb.joints[i]), "angle", q[i]);
  report(arm, limb, order.goal, solution, q);
}

void Arms::report(const Object& arm, const Limb& limb, const Goal& goal, const Solution& solution,
                  std::span<const double> q) {
  me_.set_word(arm, "status", name_of(solution.status));
  const bool blocked =
      solution.status == Status::limited || solution.status == Status::unreachable || solution.status == Status::budget;
  me_.set(arm, "reason", blocked ? limb.reacher->reason(goal, solution, q) : std::string());
  std::vector<std::int64_t> limits;
  if (blocked) {
    for (const Solver::ActiveLimit& limit : limb.reacher->active_limits(goal, q))
      limits.push_back(limb.joints[limit.joint]);
  }
  me_.set(arm, "active_limits", limits);
  me_.set_word(arm, "chosen", name_of(solution.method));
  me_.set(arm, "position_error", solution.position_error);
  me_.set(arm, "rotation_error", solution.rotation_error);
  me_.set(arm, "iterations", std::int64_t{solution.iterations});
  report_anatomy(arm, limb, q);
}

void Arms::report_anatomy(const Object& arm, const Limb& limb, std::span<const double> q) {
  if (!limb.reacher->human()) return;
  const IsbAngles angles = limb.reacher->human()->isb(q);
  me_.set(arm, "shoulder_plane", angles.plane);
  me_.set(arm, "shoulder_elevation", angles.elevation);
  me_.set(arm, "shoulder_rotation", angles.axial);
  me_.set(arm, "elbow_flexion", angles.flexion);
  me_.set(arm, "elbow_carrying", angles.carrying);
  me_.set(arm, "forearm_pronation", angles.pronation);
}

void Arms::remember() {
  for (auto& [id, limb] : limbs_) {
    const Object* arm = me_.world().object(id);
    if (arm == nullptr || !limb.known || limb.reacher == nullptr) continue;
    std::vector<double> numbers = limb.reacher->memory();
    numbers.push_back(limb.lost ? 1 : 0);
    me_.set(*arm, "memory", numbers);
    const bool there = me_.world().object(limb.target) != nullptr;
    me_.set(*arm, "remembered", static_cast<std::int64_t>(there ? limb.target : 0));
  }
}

void Arms::recall(const Object& arm, Limb& limb) {
  const std::span<const double> numbers = me_.numbers(arm, "memory");
  if (numbers.empty() || !limb.reacher->recall(numbers.first(numbers.size() - 1))) return;
  limb.lost = numbers.back() != 0;
  limb.target = static_cast<objdb::ObjectId>(me_.get<std::int64_t>(arm, "remembered"));
  limb.known = true;
}

}  // namespace arm_ik
