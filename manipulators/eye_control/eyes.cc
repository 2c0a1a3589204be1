#include "manipulators/eye_control/eyes.h"

#include <time.h>

#include <algorithm>
#include <cmath>

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
  field gaze.method word = full of snap saccade_only linear full "from geometry alone to the whole model"
  field gaze.mode word = fixation of fixation latency saccade pursuit vergence blink "what the eyes are doing"
  field gaze.status word = no_target of ok no_target out_of_range no_eyes bad_parameter
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

double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
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
  return {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
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
  std::erase_if(pairs_, [&](const auto& entry) { return me_.world().object(entry.first) == nullptr; });
  for (const Object* object : me_.objects("gaze")) {
    const double start = processor_time();
    move(*object, pairs_[object->id], now);
    me_.set(*object, "elapsed", processor_time() - start);
  }
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

const Object* Eyes::neck_of(const Object& object) const {
  if (const Object* named = me_.target(object, "neck")) return named->type->name() == "neck" ? named : nullptr;
  const std::string folder = object.path.substr(0, object.path.rfind('/') + 1);
  for (const Object* neck : me_.objects("neck")) {
    if (neck->path.starts_with(folder)) return neck;
  }
  return nullptr;
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

std::shared_ptr<const Parameters> Eyes::parameters(const Object& object, double eye_distance) const {
  auto p = std::make_shared<Parameters>();
  for (const Parameter& row : parameter_table()) {
    if (is_given(row.name)) continue;
    (*p).*row.value = row.is_switch() ? static_cast<double>(me_.get<std::int64_t>(object, row.name))
                                      : me_.get<double>(object, row.name);
  }
  p->method = *method_of(me_.word(object, "method"));
  p->eye_distance = eye_distance;
  // the seed of the whole run counts too; both stay whole numbers
  p->seed = std::fmod(std::floor(p->seed) + 1000003.0 * static_cast<double>(me_.hello().seed % 4294967296u), 0x1p53);
  return p;
}

// a pair that is new, or whose time was turned back, starts from where its eyes point
void Eyes::rest(Pair& pair, const Sockets& sockets, std::shared_ptr<const Parameters> p, const kit::Tick& now) {
  auto& scene = me_.world().scene();
  const Matrix3d R_HW = rotation_of(scene.world(*sockets.head)).transpose();
  const Vec2 left = helmholtz_angles(R_HW * rotation_of(scene.world(*sockets.left)).col(2));
  const Vec2 right = helmholtz_angles(R_HW * rotation_of(scene.world(*sockets.right)).col(2));
  pair.gaze = std::make_unique<Gaze>(p);
  const double begin = now.time - now.step;
  pair.gaze->rest({0.5 * (left + right), left.x - right.x, false},
                  static_cast<int64_t>(std::floor(begin / p->step + 1e-6)));
  pair.world = TickWorld();
  pair.target = 0;
  pair.seeing = false;
}

void Eyes::move(const Object& object, Pair& pair, const kit::Tick& now) {
  Sockets sockets{};
  if (const std::string missing = find(object, sockets); !missing.empty()) {
    me_.set_word(object, "status", "no_eyes");
    me_.set(object, "reason", missing);
    return;
  }
  const auto p = parameters(object, sockets.distance);
  if (const auto wrong = fault(*p)) {
    me_.set_word(object, "status", "bad_parameter");
    me_.set(object, "reason", *wrong);
    return;
  }

  const auto X_WH = me_.world().scene().world(*sockets.head);
  const HeadPose head{vector_of(X_WH.p) + rotation_of(X_WH) * sockets.middle, quaternion_of(X_WH)};
  if (!pair.gaze && !recall(object, pair, p)) rest(pair, sockets, p, now);
  // changed parameters: the same state goes on under them, if it fits
  if (!(pair.gaze->parameters() == *p)) {
    auto changed = std::make_unique<Gaze>(p);
    if (!changed->restore(pair.gaze->save())) changed->rest(pair.gaze->aim(), pair.gaze->step());
    pair.gaze = std::move(changed);
  }
  const double begin = now.time - now.step;
  if (std::abs(begin - static_cast<double>(pair.gaze->step()) * p->step) > 2 * p->step) rest(pair, sockets, p, now);

  const Wish wanted = wish(object);
  if (pair.world.empty()) pair.world.add(begin, head, nullptr, false);
  const bool switched = wanted.any != pair.seeing || wanted.target != pair.target;
  pair.world.add(now.time, head, wanted.any ? &wanted.place : nullptr, switched);
  pair.seeing = wanted.any;
  pair.target = wanted.target;

  const auto end = static_cast<int64_t>(std::floor(now.time / p->step + 1e-6));
  while (pair.gaze->step() < end) pair.gaze->advance(stimulus(pair.world, *pair.gaze));
  pair.world.forget(p->visual_delay + p->visual_lag + p->vor_latency + 0.1);
  show(object, pair, sockets, wanted, head);
}

// -- what it tells

void Eyes::show(const Object& object, const Pair& pair, const Sockets& sockets, const Wish& wish,
                const HeadPose& head) {
  const Gaze& gaze = *pair.gaze;
  const double range = gaze.parameters().range;
  Aim aim = gaze.aim();
  // geometry alone is asked for at the very time of the tick
  if (gaze.parameters().method == Method::snap && wish.any) {
    aim = aim_at(sight_of_point(wish.place, head), sockets.distance, range);
  }
  const Gaze::Eyes eyes = gaze.eyes(aim);
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

  const bool beyond = wish.any && aim_at(sight_of_point(wish.place, head), sockets.distance, range).beyond;
  me_.set_word(object, "status", !wish.any ? "no_target" : beyond ? "out_of_range" : "ok");
  me_.set(object, "reason",
          !beyond ? std::string()
                  : "the target lies more than " + objdb::number(std::round(range / deg)) + " deg from straight ahead");
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
    if (object == nullptr || !pair.gaze) continue;
    for (auto& [name, numbers] : pair.gaze->save()) me_.set(*object, "memory_" + name, numbers);
    std::vector<double> heads = pair.world.save_heads();
    heads.push_back(pair.seeing);
    me_.set(*object, "memory_heads", heads);
    me_.set(*object, "memory_targets", pair.world.save_targets());
    const bool known = me_.world().object(pair.target) != nullptr;
    me_.set(*object, "memory_target", static_cast<std::int64_t>(known ? pair.target : 0));
  }
}

bool Eyes::recall(const Object& object, Pair& pair, std::shared_ptr<const Parameters> p) {
  Gaze::State state;
  for (std::string_view row : rows) {
    state[std::string(row)] = me_.get<std::vector<double>>(object, "memory_" + std::string(row));
  }
  auto heads = me_.get<std::vector<double>>(object, "memory_heads");
  if (heads.empty()) return false;
  const bool seeing = heads.back() != 0;
  heads.pop_back();
  auto gaze = std::make_unique<Gaze>(std::move(p));
  TickWorld world;
  if (!gaze->restore(state) || !world.restore(heads, me_.get<std::vector<double>>(object, "memory_targets")))
    return false;
  pair.gaze = std::move(gaze);
  pair.world = std::move(world);
  pair.seeing = seeing;
  pair.target = static_cast<ObjectId>(me_.get<std::int64_t>(object, "memory_target"));
  return true;
}

}  // namespace eye
