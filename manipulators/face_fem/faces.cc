#include "manipulators/face_fem/faces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/speech.h"
#include "manipulators/face_fem/strength.h"
#include "manipulators/mesh/find.h"
#include "manipulators/mesh/read.h"
#include "objdb/text.h"
#include "objdb/unit.h"

namespace face {
namespace {

using objdb::ErrorKind;
using objdb::Object;
using objdb::Vec3;
using objdb::Words;

constexpr std::string_view fixed_declarations = R"faces(
  type face extends node "soft tissue between bone and skin of a head; express moves it"
  field face.skin ref:node "the skin or mesh whose head it moves"
  field face.gaze ref:node "the eyes that its lids go with (a gaze of eye_control); without it that of the same figure"
  field face.lids bool = true "lids follow the eyes, and blink with them"
  field face.method word = contact of basis contact solve nonlinear auto "how a frame is found: docs/face.md"
  field face.columns int = 32 in 16 128 "elements from ear to ear, even"
  field face.rows int = 32 in 16 128 "elements from chin to hair"
  field face.layers int = 3 in 3 12 "elements from bone to skin"
  field face.onset real s = 0.3 in 0 60 "usual rise of an expression"
  field face.offset real s = 0.45 in 0 60 "usual fall"
  field face.widest_jaw real rad = 0.28 in 0 0.6 "opening at AU27=1"
  field face.upper_follows real = 0.75 in 0 1 "of the eye's elevation that the upper lid goes with"
  field face.lower_follows real = 0.35 in 0 1 "likewise of the lower lid"
  field face.vertices int[] "numbers of the vertices that move, in the file of skin"
  field face.displacement vec3[] m "of each of them, in the mesh's own frame at rest"
  field face.status word = no_head of ok strain bone_turn inverted not_converged no_head no_face
  field face.reason text "one sentence, when there is something to say"
  field face.expressing text "what is being shown"
  field face.method_used word = contact of basis contact solve nonlinear
  field face.predicted_error real m "of the method, for this much motion"
  field face.predicted_time real s "of the method: nominal, the same on every machine"
  field face.jaw real rad "opening"
  field face.strain real "largest principal strain"
  field face.inverted int "elements turned inside out"
  field face.lip_gap_error real m "how far lips pass into each other"
  field face.lip_force real N "that presses the lips together"
  field face.left_lids vec3 "upper and lower lid of the left eye on their way to each other, and their sum: 1 is shut"
  field face.right_lids vec3 "likewise of the right eye"
  field face.elapsed real s measured "processor time of the last tick"
  field face.frame_time real s measured "processor time of the last frame"
  field face.setup_time real s measured "processor time of making it ready"
  field face.memory_words text[] private "gestures: their channels"
  field face.memory real[] private "gestures: their numbers"
  type muscle extends node "a strand of a muscle of the face above it: named as the face's own it takes its place"
  field muscle.origin vec3 m "in the frame of the face"
  field muscle.insertion vec3 m
  field muscle.origin_radius real m = 0 in 0 0.1 "0: this end is in bone"
  field muscle.insertion_radius real m = 0 in 0 0.1
  field muscle.force real N = 0 in -1000 1000 "at activation 1"
  field muscle.level real = 0 in 0 1 "activation of its own, besides what action units ask for"
  field muscle.activation real "now"
  type expression "an expression of your own: parts such as AU12L=0.6 AU14R=0.3 smile=0.2"
  field expression.parts text[]
  type tissue extends node "the elements of the face above it, to be seen (view.elements)"
  field tissue.nodes vec3[] m
  field tissue.elements int[] "eight corners each"
  field tissue.displacement vec3[] m
  verb express "FACE NAME[=AMOUNT]... [for DURATION] [onset DURATION] [offset DURATION]" "Shows expressions and action units (smile=0.8 AU4L=0.5), until relaxed or for a time."
  verb relax "FACE [offset DURATION]" "Lets all expressions fade."
  verb speak "FACE VISEME[=DURATION]... [length DURATION] [amount A]" "Speaks visemes, one after the other: a e i o u m f closed."
  verb muscles "FACE on|off" "Puts the muscles of a face into the world as objects, or takes them out."
  reads mesh.file
  reads gaze.left gaze.right gaze.blink eye.elevation
  writes face.vertices face.displacement face.status face.reason face.expressing face.method_used
  writes face.predicted_error face.predicted_time face.jaw face.strain face.inverted face.lip_gap_error face.lip_force
  writes face.left_lids face.right_lids
  writes muscle.origin muscle.insertion muscle.origin_radius muscle.insertion_radius muscle.force muscle.activation
  writes tissue.nodes tissue.elements tissue.displacement
  timeout 60s
)faces";

// nominal cost of a frame by method, seconds: what `budget time` chooses by
constexpr double nominal_time[] = {40e-6, 400e-6, 10e-3, 3};

std::string declarations() {
  std::string text(fixed_declarations), names;
  for (int place = 0; place < 2 * int(action_units().size()); ++place) {
    const std::string name(word_of_place(place));
    if (place % 2 == 1 && name == word_of_place(place - 1)) continue;
    const ActionUnit& unit = action_units()[std::size_t(place / 2)];
    text += "field face." + name + " real \"" + std::string(unit.name) + "\"\n";
    names += " face." + name;
  }
  return text + "writes" + names + "\n";
}

Vec3 triple(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
Eigen::Vector3d vector_of(const Vec3& v) { return {v[0], v[1], v[2]}; }

// tenths of a micrometre: short to say, and the same on machines whose last digits differ
double rounded(double metres) { return std::round(metres * 1e7) / 1e7; }

std::string figure_of(const Object& object) { return object.path.substr(0, object.path.rfind('/') + 1); }

objdb::Error at(const objdb::Word& word, const objdb::Error& error) {
  return {error.kind, error.sentence, word.column};
}

// NAME DURATION pairs and the words before them
struct Spoken {
  Words names;
  std::map<std::string_view, const objdb::Word*> options;
};

objdb::Result<Spoken> split(Words words, std::initializer_list<std::string_view> keywords, const char* syntax) {
  Spoken spoken;
  std::size_t k = 0;
  const auto is_keyword = [&](const objdb::Word& word) {
    return !word.quoted && std::find(keywords.begin(), keywords.end(), word.text) != keywords.end();
  };
  while (k < words.size() && !is_keyword(words[k])) ++k;
  spoken.names = words.subspan(0, k);
  for (; k < words.size(); k += 2) {
    if (!is_keyword(words[k]) || k + 1 == words.size() || spoken.options.contains(words[k].text))
      return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, words[k].column};
    spoken.options[words[k].text] = &words[k + 1];
  }
  return spoken;
}

// an option in seconds, `missing` without it
objdb::Result<double> duration(const Spoken& spoken, std::string_view name, double missing, bool may_be_zero = true) {
  const auto found = spoken.options.find(name);
  if (found == spoken.options.end()) return missing;
  const objdb::Word& word = *found->second;
  const auto value = objdb::parse_real(word.text, objdb::parse_unit("s")->dimension);
  if (!value) return at(word, value.error());
  if (!(*value >= 0) || (*value == 0 && !may_be_zero) || *value > 86400)
    return objdb::Error{ErrorKind::range,
                        std::string(name) + " is " + std::string(word.text) + ", expected " +
                            (may_be_zero ? "0" : "more than 0") + " to one day",
                        word.column};
  return *value;
}

}  // namespace

Faces::Faces() : me_("face_fem", declarations()) {
  me_.on_tick([this](const kit::Tick& now) { tick(now); });
  me_.on_verb("express", [this](Words words) { return express(words); });
  me_.on_verb("relax", [this](Words words) { return relax(words); });
  me_.on_verb("speak", [this](Words words) { return speak(words); });
  me_.on_verb("muscles", [this](Words words) { return show_muscles(words); });
  me_.on_checkpoint([this] { remember(); });
}

// -- verbs

Faces::Answer<const Object*> Faces::face_of(const objdb::Word& word) const {
  const auto figure = me_.object(word);
  if (!figure) return figure.error();
  for (const Object* face : me_.objects("face"))
    if (face == *figure || face->path.starts_with((*figure)->path + "/")) return face;
  return objdb::Error{ErrorKind::unknown, (*figure)->path + " has no face: no object of type face below it",
                      word.column};
}

// what a performance needs of a face is there as soon as it is spoken to, also in a fresh process
Faces::Live& Faces::live(const Object& object) {
  Live& face = faces_[object.id];
  if (!face.recalled) {
    face.recalled = true;
    face.play.recall(me_.get<std::vector<std::string>>(object, "memory_words"),
                     me_.get<objdb::Numbers>(object, "memory").vector());
  }
  return face;
}

Faces::Answer<Parts> Faces::parts_named(std::string_view word, std::string* channel) const {
  const auto amount = parse_amount(word);
  if (!amount) return amount.error();
  *channel = amount->name;
  std::vector<std::string_view> parts;
  for (const Object* own : me_.objects("expression"))
    if (own->path == amount->name)
      for (const std::string& part : me_.get<std::vector<std::string>>(*own, "parts")) parts.emplace_back(part);
  if (!parts.empty()) {
    const auto found = parse_parts(parts);
    if (!found) return objdb::Error{found.error().kind, "expression " + *channel + ": " + found.error().sentence, 0};
    return *found;
  }
  if (places_of(amount->name) || find_expression(amount->name) != nullptr) {
    const std::string_view name = amount->name;
    return parse_parts({&name, 1});
  }
  std::vector<std::string_view> names = all_names();
  for (const Object* own : me_.objects("expression")) {
    if (own->path == amount->name) return objdb::Error{ErrorKind::range, "expression " + *channel + " has no parts", 0};
    names.push_back(own->path);
  }
  return objdb::Error{
      ErrorKind::unknown,
      "no expression or action unit " + objdb::shown(amount->name) + objdb::did_you_mean(amount->name, names), 0};
}

Faces::Answer<std::string> Faces::express(Words words) {
  constexpr const char* syntax = "express FACE NAME[=AMOUNT]... [for DURATION] [onset DURATION] [offset DURATION]";
  if (words.size() < 2)
    return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, words.empty() ? 1 : words.back().column};
  const auto object = face_of(words[0]);
  if (!object) return object.error();
  const auto spoken = split(words.subspan(1), {"for", "onset", "offset"}, syntax);
  if (!spoken) return spoken.error();
  if (spoken->names.empty()) return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, words[1].column};
  const bool timed = spoken->options.contains("for");
  const auto whole = duration(*spoken, "for", 0, false);
  if (!whole) return whole.error();
  const auto onset = duration(*spoken, "onset", -1), offset = duration(*spoken, "offset", -1);
  if (!onset) return onset.error();
  if (!offset) return offset.error();
  if (timed && std::max(*onset, 0.0) + std::max(*offset, 0.0) > *whole * (1 + 1e-12))
    return objdb::Error{ErrorKind::range,
                        "onset and offset take " + objdb::number(std::max(*onset, 0.0) + std::max(*offset, 0.0)) +
                            " s, expected no more than the " + objdb::number(*whole) + " s of the whole",
                        spoken->options.at("for")->column};

  std::vector<Gesture> gestures;
  for (const objdb::Word& word : spoken->names) {
    Gesture gesture;
    const auto parts = parts_named(word.text, &gesture.channel);
    if (!parts) return at(word, parts.error());
    gesture.parts = *parts;
    gesture.amount = parse_amount(word.text)->amount;
    const NamedExpression* known = find_expression(gesture.channel);
    const auto usual = [&](double own, const char* field) { return own > 0 ? own : me_.get<double>(**object, field); };
    double up = *onset >= 0 ? *onset : usual(known != nullptr ? known->onset : 0, "onset");
    double down = *offset >= 0 ? *offset : usual(known != nullptr ? known->offset : 0, "offset");
    if (timed) {
      // usual times give way when the whole is short
      const double free = *whole - (*onset >= 0 ? up : 0) - (*offset >= 0 ? down : 0);
      const double wanted = (*onset >= 0 ? 0 : up) + (*offset >= 0 ? 0 : down);
      if (wanted > free) {
        if (*onset < 0) up *= std::max(free, 0.0) / wanted;
        if (*offset < 0) down *= std::max(free, 0.0) / wanted;
      }
    }
    gesture.envelope = {0, up, timed ? *whole - down : Envelope::held, down};
    gestures.push_back(std::move(gesture));
  }
  for (Gesture& gesture : gestures) live(**object).play.begin(std::move(gesture));
  return std::string();
}

Faces::Answer<std::string> Faces::relax(Words words) {
  constexpr const char* syntax = "relax FACE [offset DURATION]";
  if (words.empty()) return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, 1};
  const auto object = face_of(words[0]);
  if (!object) return object.error();
  const auto spoken = split(words.subspan(1), {"offset"}, syntax);
  if (!spoken) return spoken.error();
  if (!spoken->names.empty())
    return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, spoken->names[0].column};
  const auto offset = duration(*spoken, "offset", me_.get<double>(**object, "offset"));
  if (!offset) return offset.error();
  live(**object).play.relax(*offset);
  return std::string();
}

Faces::Answer<std::string> Faces::speak(Words words) {
  constexpr const char* syntax = "speak FACE VISEME[=DURATION]... [length DURATION] [amount A]";
  if (words.size() < 2)
    return objdb::Error{ErrorKind::syntax, std::string("expected ") + syntax, words.empty() ? 1 : words.back().column};
  const auto object = face_of(words[0]);
  if (!object) return object.error();
  const auto spoken = split(words.subspan(1), {"length", "amount"}, syntax);
  if (!spoken) return spoken.error();
  const auto length = duration(*spoken, "length", 0.15, false);
  if (!length) return length.error();
  double amount = 1;
  if (const auto said = spoken->options.find("amount"); said != spoken->options.end()) {
    const std::string text = "amount=" + std::string(said->second->text);
    const auto value = parse_amount(text);
    if (!value) return at(*said->second, value.error());
    amount = value->amount;
  }
  std::vector<Gesture> all;
  std::vector<std::string_view> visemes;
  for (const objdb::Word& word : spoken->names) {
    // each alone first, so that an error stands at its word
    const auto one = utterance({&word.text, 1}, *length, amount);
    if (!one) return at(word, one.error());
    visemes.push_back(word.text);
  }
  auto gestures = utterance(visemes, *length, amount);
  if (!gestures) return at(words[1], gestures.error());
  const double blend = gestures->front().envelope.onset;
  live(**object).play.begin_all(std::move(*gestures), blend);
  return std::string();
}

Faces::Answer<std::string> Faces::show_muscles(Words words) {
  if (words.size() != 2 || (words[1].text != "on" && words[1].text != "off"))
    return objdb::Error{ErrorKind::syntax, "expected muscles FACE on|off", words.empty() ? 1 : words.back().column};
  const auto object = face_of(words[0]);
  if (!object) return object.error();
  Live& face = live(**object);
  if (!make(**object, face))
    return objdb::Error{ErrorKind::unknown, (*object)->path + ": " + face.fault, words[0].column};
  const std::vector<const Object*> shown = me_.objects("muscle");
  for (const Muscle& muscle : face.placed)
    for (std::size_t k = 0; k < muscle.strands.size(); ++k) {
      const std::string path = (*object)->path + "/" + muscle.name + (k == 0 ? "" : "_" + std::to_string(k + 1));
      const bool there =
          std::any_of(shown.begin(), shown.end(), [&](const Object* each) { return each->path == path; });
      if (words[1].text == "on" && !there) me_.say("create muscle " + path);
      if (words[1].text == "off" && there) me_.say("delete " + path);
    }
  return std::string();
}

// -- a tick

void Faces::tick(const kit::Tick& now) {
  std::erase_if(faces_, [&](const auto& entry) { return me_.world().object(entry.first) == nullptr; });
  for (const Object* object : me_.objects("face")) {
    const double start = cpu_seconds();
    move(*object, live(*object), now);
    me_.set(*object, "elapsed", cpu_seconds() - start);
  }
}

// true when there is an actor for what the object names now
bool Faces::make(const Object& object, Live& face) {
  const Object* skin = me_.target(object, "skin");
  const int file_field = skin == nullptr ? -1 : skin->type->find("file");
  std::string file;
  if (file_field >= 0)
    if (const auto* text = std::get_if<std::string>(&skin->value(file_field))) file = *text;
  std::string made_of = file;
  for (const char* field : {"columns", "rows", "layers"})
    made_of += " " + std::to_string(me_.get<std::int64_t>(object, field));
  if (made_of == face.made_of) return face.actor != nullptr;

  face.made_of = made_of;
  face.actor.reset();
  face.shown = false;
  face.fault.clear();
  if (skin == nullptr) {
    face.fault = "skin names nothing";
  } else if (file.empty()) {
    face.fault = "the skin " + skin->path + " has no file";
  }
  if (!face.fault.empty()) return false;
  const auto path = mesh::find_file(file);
  if (!path) {
    face.fault = path.error().sentence;
    return false;
  }
  const auto head = mesh::read_surface(*path);
  if (!head) {
    face.fault = head.error().sentence;
    return false;
  }
  FaceOptions options;
  options.columns = int(me_.get<std::int64_t>(object, "columns"));
  options.rows = int(me_.get<std::int64_t>(object, "rows"));
  options.layers = int(me_.get<std::int64_t>(object, "layers"));
  const double start = cpu_seconds();
  auto built = build_face(*head, options);
  if (!built) {
    face.fault = file + ": " + built.error().sentence;
    return false;
  }
  auto actor = Actor::make(strengthened(std::move(*built)));
  if (!actor) {
    face.fault = file + ": " + actor.error().sentence;
    return false;
  }
  face.actor = std::move(*actor);
  face.actor->set_surface(head->V);
  face.placed = face.actor->face().muscles;
  std::vector<std::string> names;
  for (const Muscle& muscle : face.placed) names.push_back(muscle.name);
  face.driver = std::make_unique<Driver>(names);
  me_.set(object, "setup_time", cpu_seconds() - start);
  me_.set(object, "vertices", std::vector<std::int64_t>(face.actor->vertices().begin(), face.actor->vertices().end()));
  return true;
}

const Object* Faces::gaze_of(const Object& object) const {
  if (const Object* named = me_.target(object, "gaze")) return named->type->name() == "gaze" ? named : nullptr;
  for (const Object* gaze : me_.objects("gaze"))
    if (gaze->path.starts_with(figure_of(object))) return gaze;
  return nullptr;
}

Eyes Faces::eyes_of(const Object& object) const {
  Eyes eyes;
  if (me_.get<std::int64_t>(object, "lids") == 0) return eyes;
  const Object* gaze = gaze_of(object);
  if (gaze == nullptr) return eyes;
  const double blink = me_.get<double>(*gaze, "blink");
  eyes.blink = {blink, blink};
  for (std::size_t side : {0, 1})
    if (const Object* eye = me_.target(*gaze, side == 0 ? "left" : "right"))
      eyes.elevation[side] = me_.get<double>(*eye, "elevation");
  return eyes;
}

// objects of type muscle below the face: those named as a muscle of its own stand for it, others are added
void Faces::place_muscles(const Object& object, Live& face, std::vector<double>* own_levels) {
  const std::string fault_before = std::exchange(face.muscle_fault, {});
  std::vector<Muscle> wanted = face.placed;
  std::vector<std::pair<const Object*, std::size_t>> shown;
  for (const Object* one : me_.objects("muscle")) {
    if (!one->path.starts_with(object.path + "/")) continue;
    const std::string name = one->path.substr(object.path.size() + 1);
    std::size_t m = 0, k = 0;
    const auto named = [&] {
      for (m = 0; m < face.placed.size(); ++m)
        for (k = 0; k < face.placed[m].strands.size(); ++k)
          if (name == face.placed[m].name + (k == 0 ? "" : "_" + std::to_string(k + 1))) return true;
      return false;
    };
    const Vec3 from = me_.get<Vec3>(*one, "origin"), to = me_.get<Vec3>(*one, "insertion");
    const double r0 = me_.get<double>(*one, "origin_radius"), r1 = me_.get<double>(*one, "insertion_radius");
    const bool blank = from == to && r0 == 0 && r1 == 0;
    Strand strand{vector_of(from), vector_of(to), r0, r1, me_.get<double>(*one, "force")};
    if (named()) {
      if (blank) {
        // it was only named: it becomes the face's own
        const Strand& own = face.placed[m].strands[k];
        me_.set(*one, "origin", triple(own.origin));
        me_.set(*one, "insertion", triple(own.insertion));
        me_.set(*one, "origin_radius", own.origin_radius);
        me_.set(*one, "insertion_radius", own.insertion_radius);
        me_.set(*one, "force", own.force);
        strand = own;
      }
      wanted[m].strands[k] = strand;
    } else {
      if (blank) continue;
      m = wanted.size();
      wanted.push_back({name, {strand}});
    }
    shown.emplace_back(one, m);
  }
  own_levels->assign(wanted.size(), 0.0);
  for (const auto& [one, m] : shown) (*own_levels)[m] = std::max((*own_levels)[m], me_.get<double>(*one, "level"));

  const auto same = [](const Muscle& a, const Muscle& b) {
    return std::equal(
        a.strands.begin(), a.strands.end(), b.strands.begin(), b.strands.end(), [](const Strand& s, const Strand& t) {
          return s.origin == t.origin && s.insertion == t.insertion && s.origin_radius == t.origin_radius &&
                 s.insertion_radius == t.insertion_radius && s.force == t.force;
        });
  };
  Actor& actor = *face.actor;
  for (int m = 0; m < int(wanted.size()); ++m) {
    if (m < actor.muscles() && same(wanted[std::size_t(m)], actor.muscle(m))) continue;
    const auto status = actor.set_muscle(m, wanted[std::size_t(m)]);
    if (!status) {
      face.muscle_fault = status.error().sentence;
      // a new one that cannot be placed leaves those after it out, too: their numbers depend on it
      if (m == actor.muscles()) break;
      continue;
    }
    face.shown = false;
  }
  if (face.muscle_fault != fault_before) face.shown = false;
}

// auto: the dearest that fits the time, or the cheapest that fits the error; without a budget the usual one
FaceMethod Faces::method_of(const Object& object, const Live& face, const Drive& drive) const {
  const std::string_view word = me_.word(object, "method");
  for (const FaceMethod method : all_face_methods)
    if (word == name_of(method)) return method;
  const kit::Budget& budget = me_.budget();
  if (budget.of == kit::Budget::Of::time) {
    FaceMethod chosen = FaceMethod::basis;
    for (const FaceMethod method : {FaceMethod::contact, FaceMethod::nonlinear})
      if (nominal_time[static_cast<std::size_t>(method)] <= budget.value) chosen = method;
    return chosen;
  }
  if (budget.of == kit::Budget::Of::error && face.actor->frame(drive, FaceMethod::contact).error > budget.value)
    return FaceMethod::nonlinear;
  return FaceMethod::contact;
}

void Faces::move(const Object& object, Live& face, const kit::Tick& now) {
  const Levels levels = face.play.advance(now.time - now.step, now.time);
  me_.set(object, "expressing", face.play.playing());
  show_levels(object, levels);
  if (!make(object, face)) {
    me_.set_word(object, "status", me_.target(object, "skin") == nullptr ? "no_head" : "no_face");
    me_.set(object, "reason", face.fault);
    return;
  }
  std::vector<double> own_levels;
  place_muscles(object, face, &own_levels);
  Habits habits;
  habits.widest_jaw = me_.get<double>(object, "widest_jaw");
  habits.upper_follows = me_.get<double>(object, "upper_follows");
  habits.lower_follows = me_.get<double>(object, "lower_follows");
  habits.aperture = face.actor->aperture();
  Drive drive = face.driver->drive(levels, eyes_of(object), habits);
  drive.activation.resize(std::size_t(face.actor->muscles()), 0.0);
  for (std::size_t m = 0; m < std::min(own_levels.size(), drive.activation.size()); ++m)
    drive.activation[m] = 1 - (1 - drive.activation[m]) * (1 - own_levels[m]);
  show(object, face, drive);
}

// -- what it tells

void Faces::show_levels(const Object& object, const Levels& levels) {
  for (int place = 0; place < 2 * int(action_units().size()); ++place) {
    const std::string_view name = word_of_place(place);
    if (place % 2 == 1 && name == word_of_place(place - 1)) continue;
    me_.set(object, name, levels[std::size_t(place)]);
  }
}

void Faces::show(const Object& object, Live& face, const Drive& drive) {
  const FaceMethod method = method_of(object, face, drive);
  const bool same = face.shown && face.method == method && face.drive == drive;
  if (!same) {
    const double start = cpu_seconds();
    const Frame frame = face.actor->frame(drive, method);
    me_.set(object, "frame_time", cpu_seconds() - start);
    me_.fill(object, "displacement", frame.displacement.size(), [&](std::span<double> numbers) {
      for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = rounded(double(frame.displacement[k]));
    });
    face.drive = drive;
    face.method = method;
    face.shown = true;
    report(object, face, frame, method);
    const auto lids = [](const LidPose& pose) { return Vec3{pose.upper, pose.lower, pose.upper + pose.lower}; };
    me_.set(object, "left_lids", lids(drive.lids[left]));
    me_.set(object, "right_lids", lids(drive.lids[right]));
    for (const Object* one : me_.objects("muscle")) {
      if (!one->path.starts_with(object.path + "/")) continue;
      const std::string name = one->path.substr(object.path.size() + 1);
      for (int m = 0; m < face.actor->muscles(); ++m) {
        const Muscle& muscle = face.actor->muscle(m);
        for (std::size_t k = 0; k < muscle.strands.size(); ++k)
          if (name == muscle.name + (k == 0 ? "" : "_" + std::to_string(k + 1)))
            me_.set(*one, "activation", drive.activation[std::size_t(m)]);
      }
    }
  }
  show_tissues(object, face, drive);
}

void Faces::report(const Object& object, const Live& face, const Frame& frame, FaceMethod method) {
  me_.set_word(object, "method_used", name_of(method));
  me_.set(object, "predicted_error", rounded(frame.error));
  me_.set(object, "predicted_time", nominal_time[static_cast<std::size_t>(method)]);
  me_.set(object, "jaw", frame.jaw);
  me_.set(object, "strain", std::round(frame.validity.strain * 1e4) / 1e4);
  me_.set(object, "inverted", std::int64_t{frame.validity.inverted});
  me_.set(object, "lip_gap_error", rounded(std::max(frame.lip_gap, 0.0)));
  me_.set(object, "lip_force", std::round(frame.lip_force * 1e4) / 1e4);
  std::string reason;
  const auto add = [&](const std::string& sentence) { reason += (reason.empty() ? "" : "; ") + sentence; };
  if (!frame.converged)
    add(method == FaceMethod::nonlinear
            ? "Newton's method reached " + objdb::number(std::round(100 * frame.reached)) + " % of the motion"
            : "the contact of the lips did not settle");
  Validity validity = frame.validity;
  if (method == FaceMethod::nonlinear) {
    // large strain and turns are what it is for
    validity.strain = 0;
    validity.bone_turn = 0;
  }
  for (const std::string& warning : warnings_of(face.actor->face().model, validity)) add(warning);
  if (!face.muscle_fault.empty()) add(face.muscle_fault);
  me_.set_word(object, "status", frame.converged ? validity.word() : "not_converged");
  me_.set(object, "reason", reason);
}

void Faces::show_tissues(const Object& object, const Live& face, const Drive& drive) {
  for (const Object* tissue : me_.objects("tissue")) {
    if (!tissue->path.starts_with(object.path + "/")) continue;
    const Model& model = face.actor->face().model;
    std::vector<double> nodes, displacement;
    for (const Eigen::Vector3d& node : model.nodes)
      for (int i = 0; i < 3; ++i) nodes.push_back(rounded(node[i]));
    std::vector<std::int64_t> elements;
    for (const Hexahedron& hexahedron : model.hexahedra)
      for (int a = 0; a < 8; ++a) elements.push_back(hexahedron.node[std::size_t(a)]);
    const Field u = face.actor->field(drive);
    for (int n = 0; n < u.cols(); ++n)
      for (int i = 0; i < 3; ++i) displacement.push_back(rounded(u(i, n)));
    me_.set(*tissue, "nodes", std::move(nodes));
    me_.set(*tissue, "elements", std::move(elements));
    me_.set(*tissue, "displacement", std::move(displacement));
  }
}

// -- checkpoints

void Faces::remember() {
  for (const auto& [id, face] : faces_) {
    const Object* object = me_.world().object(id);
    if (object == nullptr) continue;
    const auto [words, numbers] = face.play.memory();
    me_.set(*object, "memory_words", words);
    me_.set(*object, "memory", numbers);
  }
}

}  // namespace face
