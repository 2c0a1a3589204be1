#include "manipulators/eye_control/eyes.h"

#include <algorithm>
#include <cmath>

#include "manipulators/eye_control/methods.h"
#include "manipulators/eye_control/processor_time.h"
#include "objdb/text.h"

namespace eye {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using objdb::Object;
using objdb::ObjectId;
using objdb::Vec3;

namespace {

constexpr std::string_view fixed_declarations = R"eyes(
  type eye extends node "an eyeball: its frame is the eye's centre in the head; it looks along its +Z"
  field eye.azimuth real rad "line of sight in the head, to the person's right"
  field eye.elevation real rad "line of sight in the head, upwards"
  field eye.torsion real rad "about the line of sight, clockwise as the person sees it (Listing's coordinates)"
  type gaze extends node "moves a pair of eyes: saccades, pursuit, vergence and reflexes"
  field gaze.left ref:eye "the left eye"
  field gaze.right ref:eye "the right eye"
  field gaze.head ref:node "the head that carries them"
  field gaze.target ref:node "what the eyes alone look at; without it they look where the neck does"
  field gaze.neck ref:node "whose look to take part in; without it the neck of the same figure"
  field gaze.follow bool = true "take part in the look of the neck"
  field gaze.method word = full of auto snap saccade_only linear full "from geometry alone to the whole model; auto: by the budget"
  field gaze.method_used word = full of snap saccade_only linear full "the method that moves the eyes"
  field gaze.predicted_error real rad "measured angle between its gaze and that of the whole model, root mean square"
  field gaze.predicted_time real s "measured processor time of a figure in a tick"
  field gaze.mode word = fixation of fixation latency saccade pursuit vergence blink "what the eyes are doing"
  field gaze.status word = no_target of ok no_target out_of_range too_near no_eyes bad_parameter
  field gaze.reason text "one sentence, when there is something to say"
  field gaze.gaze_error real rad "line of sight to target, the worse of both eyes"
  field gaze.vergence real rad "angle between both lines of sight"
  field gaze.trust real "how far target motion is predicted, 0 to 1"
  field gaze.saccades int "since the eyes were met"
  field gaze.blink real "lid closure, 0 open to 1 closed"
  field gaze.elapsed real s measured "processor time of the last tick"
  verb gaze "FIGURE TARGET|none" "Turns the eyes of a figure alone towards a node; none: back to where the neck looks."
  reads node.parent node.position node.orientation
  reads joint.dh joint.angle
  reads neck.target neck.point neck.active
  writes eye.orientation eye.azimuth eye.elevation eye.torsion
  writes gaze.method_used gaze.predicted_error gaze.predicted_time
  writes gaze.target gaze.mode gaze.status gaze.reason gaze.gaze_error gaze.vergence gaze.trust gaze.saccades gaze.blink
)eyes";

// parameters that the world gives instead of a field
bool is_given(std::string_view name) { return name == "step" || name == "eye_distance" || name.starts_with("head_"); }

// rows of the state that a checkpoint writes, as fields memory_NAME
constexpr std::string_view rows[] = {"now",    "command",   "velocity", "copy", "position", "head",
                                     "reflex", "disparity", "vergence", "lid",  "swept"};

std::string declarations() {
  std::string text(fixed_declarations);
  const Parameters defaults;
  for (const Parameter& p : parameter_table()) {
    if (is_given(p.name)) continue;
    text += "field gaze." + std::string(p.name);
    if (p.is_switch()) {
      text += " bool = " + std::string(defaults.*p.value >= 0.5 ? "true" : "false");
    } else {
      text += " real " + std::string(p.wire_unit()) + " = " + objdb::number(defaults.*p.value) + " in " +
              objdb::number(p.low) + " " + objdb::number(p.high);
    }
    text += " \"" + std::string(p.doc) + "\"\n";
  }
  for (std::string_view row : rows) text += "field gaze.memory_" + std::string(row) + " real[] private\n";
  text += "field gaze.memory_heads real[] private\nfield gaze.memory_targets real[] private\n";
  text += "field gaze.memory_target ref:node private\n";
  return text;
}

constexpr double least_distance = 0.02;  // to the middle of the eyes, m

double two_digits(double x) {
  if (!(x > 0)) return 0;
  // a quotient of whole numbers, so that it is written with two digits too
  const double parts = std::round(std::pow(10.0, 1 - std::floor(std::log10(x))));
  return parts >= 1 ? std::round(x * parts) / parts : std::round(x);
}

Vector3d vector_of(const Vec3& p) { return {p[0], p[1], p[2]}; }

Matrix3d rotation_of(const objdb::scene::Transform& x) {
  Matrix3d R;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) R(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = x.R[i][j];
  }
  return R;
}

Quaterniond quaternion_of(const objdb::scene::Transform& x) {
  const objdb::Quat q = objdb::scene::quaternion(x);
  return {q[0], q[1], q[2], q[3]};
}

objdb::Quat words_of(Quaterniond q) {
  q.normalize();
  const double sign = q.w() < 0 ? -1 : 1;
  // no minus zero
  return {sign * q.w() + 0.0, sign * q.x() + 0.0, sign * q.y() + 0.0, sign * q.z() + 0.0};
}

}  // namespace

Eyes::Eyes() : me_("eye_control", declarations()) {
  me_.on_tick([this](const kit::Tick& now) { tick(now); });
  me_.on_verb("gaze", [this](objdb::Words words) { return look(words); });
  me_.on_checkpoint([this] { remember(); });
}

// -- the verb

objdb::Result<std::string> Eyes::look(objdb::Words words) {
  if (words.size() != 2) {
    return objdb::Error{objdb::ErrorKind::syntax, "expected gaze FIGURE TARGET|none",
                        words.empty() ? 1 : words.back().column};
  }
  const objdb::Result<const Object*> figure = me_.object(words[0]);
  if (!figure) return figure.error();
  const Object* found = nullptr;
  for (const Object* gaze : me_.objects("gaze")) {
    if (gaze == *figure || gaze->path.starts_with((*figure)->path + "/")) {
      found = gaze;
      break;
    }
  }
  if (found == nullptr) {
    return objdb::Error{objdb::ErrorKind::unknown, (*figure)->path + " has no eyes: no object of type gaze below it",
                        words[0].column};
  }
  std::int64_t target = 0;
  if (words[1].quoted || words[1].text != "none") {
    const objdb::Result<const Object*> node = me_.object(words[1], "node");
    if (!node) return node.error();
    target = (*node)->id;
  }
  me_.set(*found, "target", target);
  return std::string();
}

// -- a tick

void Eyes::tick(const kit::Tick& now) {
  const double start = processor_time();
  std::erase_if(pairs_, [&](const auto& entry) { return me_.world().object(entry.first) == nullptr; });
  necks_.clear();
  necks_known_ = false;
  const auto objects = me_.objects("gaze");
  automatic_ = chosen(objects.size(), now.step);
  steps_ = now.step / Parameters().step;
  std::vector<Pair*> ready;
  for (const Object* object : objects) {
    Pair& pair = pairs_[object->id];
    if (prepare(*object, pair, now)) {
      ready.push_back(&pair);
    } else {
      pair.seat.leave();
    }
  }

  const auto end = static_cast<int64_t>(std::floor(now.time / Parameters().step + 1e-6));
  crowd_.advance(end, [](void* who, const Crowd::Table& table, size_t lane) {
    Pair& pair = *static_cast<Pair*>(who);
    return stimulus(pair.world, table.parameters(), pair.parameters.eye_distance, table.step(), table.aim(lane),
                    pair.sighting);
  });
  for (Pair* pair : ready) {
    const Parameters& p = pair->parameters;
    pair->world.forget(p.visual_delay + p.visual_lag + p.vor_latency + 0.1);
    show(*pair);
  }
  // figures are moved together, so each is told its share; two digits, or it would be told anew in every tick
  const double share =
      two_digits((processor_time() - start) / static_cast<double>(std::max<size_t>(objects.size(), 1)));
  for (const Object* object : objects) me_.set(*object, "elapsed", share);
}

// the method of those that leave it to the budget
Method Eyes::chosen(size_t figures, double step) const {
  const kit::Budget& budget = me_.budget();
  if (budget.of == kit::Budget::Of::error) return within_error(budget.value);
  if (budget.of == kit::Budget::Of::time) return within_time(budget.value, figures, step / Parameters().step);
  return Method::full;
}

// where the eyes sit; else a sentence that says what is missing
std::string Eyes::find(const Object& object, Sockets& sockets) {
  sockets.left = me_.target(object, "left");
  sockets.right = me_.target(object, "right");
  sockets.head = me_.target(object, "head");
  if (sockets.left == nullptr) return "left names no eye";
  if (sockets.right == nullptr) return "right names no eye";
  if (sockets.head == nullptr) return "head names no node";
  if (sockets.left == sockets.right) return "left and right name the same eye";
  auto& scene = me_.world().scene();
  const auto X_HW = objdb::scene::inverse(scene.world(*sockets.head));
  const Vector3d left = vector_of((X_HW * scene.world(*sockets.left)).p);
  const Vector3d right = vector_of((X_HW * scene.world(*sockets.right)).p);
  sockets.middle = 0.5 * (left + right);
  sockets.distance = std::clamp(left.x() - right.x(), 0.0, 1.0);
  return "";
}

const Object* Eyes::neck_of(const Object& object) {
  if (const Object* named = me_.target(object, "neck")) return named->type->name() == "neck" ? named : nullptr;
  if (!necks_known_) {
    for (const Object* neck : me_.objects("neck")) {
      const std::string_view path = neck->path;
      necks_.emplace("", neck);
      for (size_t end = path.find('/'); end != path.npos; end = path.find('/', end + 1)) {
        necks_.emplace(path.substr(0, end + 1), neck);
      }
    }
    necks_known_ = true;
  }
  const std::string_view path = object.path;
  const auto found = necks_.find(path.substr(0, path.rfind('/') + 1));
  return found == necks_.end() ? nullptr : found->second;
}

Eyes::Wish Eyes::wish(const Object& object) {
  Wish wish;
  const Object* target = me_.target(object, "target");
  if (target == nullptr && me_.get<std::int64_t>(object, "follow") != 0) {
    const Object* neck = neck_of(object);
    if (neck == nullptr || me_.get<std::int64_t>(*neck, "active") == 0) return wish;
    target = me_.target(*neck, "target");
    if (target == nullptr) {
      wish.any = true;
      wish.place = vector_of(me_.get<Vec3>(*neck, "point"));
      return wish;
    }
  }
  if (target == nullptr) return wish;
  wish.any = true;
  wish.target = target->id;
  wish.place = vector_of(me_.world().scene().world(*target).p);
  return wish;
}

Parameters Eyes::parameters(const Object& object, double eye_distance) {
  const auto table = parameter_table();
  if (fields_of_ != object.type) {
    fields_of_ = object.type;
    fields_.clear();
    for (const Parameter& row : table) fields_.push_back(is_given(row.name) ? -1 : object.type->find(row.name));
  }
  Parameters p;
  for (size_t k = 0; k < table.size(); ++k) {
    if (fields_[k] < 0) continue;
    const objdb::Value& value = object.value(fields_[k]);
    p.*table[k].value =
        table[k].is_switch() ? static_cast<double>(std::get<std::int64_t>(value)) : std::get<double>(value);
  }
  const std::string_view method = me_.word(object, "method");
  p.method = method == "auto" ? automatic_ : *method_of(method);
  p.eye_distance = eye_distance;
  // the seed of the whole run counts too; both stay whole numbers
  p.seed = std::fmod(std::floor(p.seed) + 1000003.0 * static_cast<double>(me_.hello().seed % 4294967296u), 0x1p53);
  return p;
}

// the step at which a tick begins
namespace {
int64_t first_step(const kit::Tick& now) {
  return static_cast<int64_t>(std::floor((now.time - now.step) / Parameters().step + 1e-6));
}
// the same time, up to a rate that has just changed
bool about(int64_t a, int64_t b) { return std::abs(a - b) <= 2; }
uint64_t seed_of(const Parameters& p) { return static_cast<uint64_t>(p.seed); }
}  // namespace

// a pair that is new, or whose time was turned back, starts from where its eyes point
void Eyes::rest(Pair& pair, const kit::Tick& now) {
  auto& scene = me_.world().scene();
  const Matrix3d R_HW = rotation_of(scene.world(*pair.sockets.head)).transpose();
  const Vec2 left = helmholtz_angles(R_HW * rotation_of(scene.world(*pair.sockets.left)).col(2));
  const Vec2 right = helmholtz_angles(R_HW * rotation_of(scene.world(*pair.sockets.right)).col(2));
  pair.seat = crowd_.seat(pair.parameters, first_step(now), &pair);
  pair.seat.rest({0.5 * (left + right), left.x - right.x, false}, seed_of(pair.parameters));
  pair.world = TickWorld();
  pair.target = 0;
  pair.seeing = false;
}

// a seat under these parameters; what sat before goes on
void Eyes::sit(Pair& pair, const Parameters& p, const kit::Tick& now) {
  const bool changed = !(pair.parameters == p);
  pair.parameters = p;
  const int64_t step = first_step(now);
  if (pair.seat.taken() && !about(pair.seat.step(), step)) pair.seat.leave();
  if (!pair.seat.taken()) {
    if (!recall(pair, step)) rest(pair, now);
  } else if (changed) {
    const auto state = pair.seat.save();
    const Aim aim = pair.seat.aim();
    pair.seat = crowd_.seat(p, pair.seat.step(), &pair);
    if (!pair.seat.restore(state, seed_of(p))) pair.seat.rest(aim, seed_of(p));
  }
}

// everything that is known before the eyes move; false, and said why, if they cannot
bool Eyes::prepare(const Object& object, Pair& pair, const kit::Tick& now) {
  pair.object = &object;
  if (const std::string missing = find(object, pair.sockets); !missing.empty()) {
    me_.set_word(object, "status", "no_eyes");
    me_.set(object, "reason", missing);
    return false;
  }
  const Parameters p = parameters(object, pair.sockets.distance);
  if (!pair.seat.taken() || !(p == pair.parameters)) {
    if (const auto wrong = fault(p)) {
      me_.set_word(object, "status", "bad_parameter");
      me_.set(object, "reason", *wrong);
      return false;
    }
  }
  const auto X_WH = me_.world().scene().world(*pair.sockets.head);
  pair.head = {vector_of(X_WH.p) + rotation_of(X_WH) * pair.sockets.middle, quaternion_of(X_WH)};
  sit(pair, p, now);

  pair.wish = wish(object);
  if (pair.world.empty()) pair.world.add(now.time - now.step, pair.head, nullptr, false);
  const bool switched = pair.wish.any != pair.seeing || pair.wish.target != pair.target;
  pair.world.add(now.time, pair.head, pair.wish.any ? &pair.wish.place : nullptr, switched);
  pair.seeing = pair.wish.any;
  pair.target = pair.wish.target;
  return true;
}

// -- what it tells

void Eyes::show(const Pair& pair) {
  const Object& object = *pair.object;
  const Sockets& sockets = pair.sockets;
  const Wish& wish = pair.wish;
  const HeadPose& head = pair.head;
  const Crowd::Seat& gaze = pair.seat;
  const double range = pair.parameters.range;
  const Aim target = wish.any ? aim_at(sight_of_point(wish.place, head), sockets.distance, range) : Aim{};
  // geometry alone is asked for at the very time of the tick
  const Aim aim = pair.parameters.method == Method::snap && wish.any ? target : gaze.aim();
  const EyePair eyes = eyes_of(aim, pair.parameters);
  auto& scene = me_.world().scene();
  double error = 0;
  const struct {
    const Object* object;
    const Vector3d& direction;
    const Quaterniond& orientation;
  } both[] = {{sockets.left, eyes.left_direction, eyes.left}, {sockets.right, eyes.right_direction, eyes.right}};
  for (const auto& one : both) {
    // an eye may hang below a socket that is turned against the head
    const Object* parent = me_.world().object(scene.parent_of(*one.object));
    const Quaterniond R_WP = parent == nullptr ? Quaterniond::Identity() : quaternion_of(scene.world(*parent));
    const Quaterniond local =
        parent == sockets.head ? one.orientation : R_WP.conjugate() * head.orientation * one.orientation;
    me_.set(*one.object, "orientation", words_of(local));
    const Vec2 angles = fick_angles(one.direction);
    me_.set(*one.object, "azimuth", angles.x);
    me_.set(*one.object, "elevation", angles.y);
    me_.set(*one.object, "torsion", torsion(one.orientation));
    if (!wish.any) continue;
    const Vector3d line = head.orientation * one.direction;
    const Vector3d to = wish.place - vector_of(scene.world(*one.object).p);
    error = std::max(error, std::atan2(line.cross(to).norm(), line.dot(to)));
  }

  const bool near = wish.any && (wish.place - head.position).norm() < least_distance;
  const char* status = !wish.any ? "no_target" : near ? "too_near" : target.beyond ? "out_of_range" : "ok";
  me_.set_word(object, "status", status);
  std::string reason;
  if (near) reason = "the target lies within 2 cm of the eyes";
  if (!near && target.beyond) {
    reason = "the target lies more than " + objdb::number(std::round(range / deg)) + " deg from straight ahead";
  }
  me_.set(object, "reason", reason);
  const Method method = pair.parameters.method;
  me_.set_word(object, "method_used", word(method));
  me_.set(object, "predicted_error", row_of(method).error);
  me_.set(object, "predicted_time", tick_cost(method, steps_));
  me_.set_word(object, "mode", word(gaze.mode()));
  me_.set(object, "gaze_error", error);
  me_.set(object, "vergence", aim.vergence);
  const Vec2 trust = gaze.trust();
  me_.set(object, "trust", std::max(trust.x, trust.y));
  me_.set(object, "saccades", gaze.saccades());
  me_.set(object, "blink", gaze.lid());
}

// -- checkpoints

void Eyes::remember() {
  for (const auto& [id, pair] : pairs_) {
    const Object* object = me_.world().object(id);
    if (object == nullptr || !pair.seat.taken()) continue;
    for (auto& [name, numbers] : pair.seat.save()) me_.set(*object, "memory_" + name, numbers);
    std::vector<double> heads = pair.world.save_heads();
    heads.push_back(pair.seeing);
    me_.set(*object, "memory_heads", heads);
    me_.set(*object, "memory_targets", pair.world.save_targets());
    const bool known = me_.world().object(pair.target) != nullptr;
    me_.set(*object, "memory_target", static_cast<std::int64_t>(known ? pair.target : 0));
  }
}

// where a checkpoint left off, if it is of this time
bool Eyes::recall(Pair& pair, int64_t step) {
  const Object& object = *pair.object;
  std::vector<double> heads = me_.get<objdb::Numbers>(object, "memory_heads").vector();
  if (heads.empty()) return false;
  const bool seeing = heads.back() != 0;
  heads.pop_back();
  Crowd::Table::State state;
  for (std::string_view row : rows) {
    state[std::string(row)] = me_.get<objdb::Numbers>(object, "memory_" + std::string(row)).vector();
  }
  if (!about(Crowd::Table::step_of(state), step)) return false;
  TickWorld world;
  if (!world.restore(heads, me_.get<objdb::Numbers>(object, "memory_targets").vector())) return false;
  Crowd::Seat seat = crowd_.seat(pair.parameters, Crowd::Table::step_of(state), &pair);
  if (!seat.restore(state, seed_of(pair.parameters))) return false;
  pair.seat = std::move(seat);
  pair.world = std::move(world);
  pair.seeing = seeing;
  pair.target = static_cast<ObjectId>(me_.get<std::int64_t>(object, "memory_target"));
  return true;
}

}  // namespace eye
