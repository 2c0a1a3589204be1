#include "manipulators/render/service.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "manipulators/render/look.h"
#include "manipulators/render/sheet.h"

namespace render {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Object;
using objdb::ObjectId;
using objdb::Result;
using objdb::Word;
using objdb::Words;

namespace {

// fields that this program writes itself: their change is no news
bool is_own(const Object& object, const std::string& field) {
  static const std::string_view own[] = {"status", "reason",    "window",   "drawn",
                                         "culled", "triangles", "cpu_time", "seen"};
  const std::string& type = object.type->name();
  return (type == "view" || field == "status" || field == "reason") &&
         std::find(std::begin(own), std::end(own), field) != std::end(own);
}

Error io(std::string sentence) { return {ErrorKind::io, std::move(sentence), 0}; }

// does the picture change with time alone?
bool shows_time(const objdb::Database& world, const Object* view) {
  if (!view) return false;
  if (word_of(*view, "ground") == "sea" || !objects_of(world, *view, "trails").empty()) return true;
  const objdb::Value* overlay = value_of(*view, "overlay");
  const auto* lines = overlay ? std::get_if<std::vector<std::string>>(overlay) : nullptr;
  return lines && std::find(lines->begin(), lines->end(), "time") != lines->end();
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", value);
  return text;
}

}  // namespace

Service::Service(kit::Manipulator& me) : me_(me), feed_(me.world().subscribe()) {
  me_.on_tick([this](const kit::Tick& now) { tick(now); });
  me_.on_verb("snapshot", [this](Words words) { return snapshot(words); });
  me_.on_verb("sheet", [this](Words words) { return sheet(words); });
  me_.on_verb("movie", [this](Words words) { return movie(words); });
  me_.on_verb("export", [this](Words words) { return export_scene(words); });
  me_.on_verb("animate", [this](Words words) { return animate(words); });
  me_.on_verb("window", [this](Words words) { return window(words); });
  me_.on_verb("bind", [this](Words words) { return bind(words); });
  me_.on_verb("unbind", [this](Words words) { return unbind(words); });
}

int Service::run() { return me_.run(); }

std::uint64_t Service::stamp() {
  me_.world().read_feed(feed_, [this](const objdb::Database::Event& event, const Object& object) {
    if (event.field < 0 || !is_own(object, object.type->field(event.field).name)) ++stamp_;
  });
  return stamp_;
}

Outcome Service::take(const Request& request, double time, Picture& picture) {
  const std::uint64_t now = stamp();
  // without anything that moves by itself a later picture of the same world is the same picture
  const double shown_time = shows_time(me_.world(), request.view) ? time : 0;
  Outcome outcome = studio_.take(me_.world(), request, shown_time, now, picture);
  tell(request, outcome);
  return outcome;
}

void Service::tell(const Request& request, const Outcome& outcome) {
  objdb::Database& world = me_.world();
  for (const Report& report : studio_.stage().reports()) {
    const Object* mesh = world.object(report.object);
    if (!mesh) continue;
    me_.set_word(*mesh, "status", report.status);
    me_.set(*mesh, "reason", report.reason);
  }
  if (!request.view) return;
  const Object& view = *request.view;
  me_.set_word(view, "status", outcome.status);
  me_.set(view, "reason", outcome.reason);
  me_.set(view, "drawn", static_cast<std::int64_t>(outcome.cost.drawn));
  me_.set(view, "culled", static_cast<std::int64_t>(outcome.cost.culled));
  me_.set(view, "triangles", static_cast<std::int64_t>(outcome.cost.triangles));
  me_.set(view, "cpu_time", outcome.cost.cpu_seconds);

  // whole figures, faces, eyes and skins: what other programs could rest
  std::vector<std::int64_t> seen;
  for (std::string_view type : {"figure", "head", "face", "eye", "skin"}) {
    for (const Object* object : all_of(world, type)) {
      const bool is_seen = std::any_of(outcome.seen.begin(), outcome.seen.end(), [&](const std::string& path) {
        return path == object->path || path.starts_with(object->path + "/");
      });
      if (is_seen) seen.push_back(object->id);
    }
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  me_.set(view, "seen", seen);
}

Service::Reply Service::snapshot(Words words) {
  auto request = parse_request(me_.world(), words, {"from", "size", "quality", "with"});
  if (!request) return request.error();
  if (request->files.size() != 1) {
    return Error{ErrorKind::syntax,
                 "expected one file: snapshot FILE.png [from CAMERA] [size WxH] [quality WORD] [with VIEW]",
                 words.empty() ? 1 : words.back().column};
  }
  if (!request->files[0].ends_with(".png")) {
    return Error{ErrorKind::range, "a snapshot is a .png file, not " + objdb::shown(request->files[0]),
                 words[0].column};
  }
  Picture picture;
  const Outcome outcome = take(*request, now_, picture);
  if (outcome.status == "failed") return io(outcome.reason);
  if (std::string problem = write_png(picture, request->files[0]); !problem.empty()) return io(problem);
  return std::string();
}

Service::Reply Service::sheet(Words words) {
  auto request = parse_request(me_.world(), words, {"columns", "size"});
  if (!request) return request.error();
  if (request->files.size() < 2) {
    return Error{ErrorKind::syntax, "expected a file and its pictures: sheet FILE.png PICTURE.png...",
                 words.empty() ? 1 : words.back().column};
  }
  std::vector<SheetItem> items;
  for (std::size_t i = 1; i < request->files.size(); ++i) {
    SheetItem item;
    if (std::string problem = read_png(request->files[i], item.picture); !problem.empty()) return io(problem);
    item.name = std::filesystem::path(request->files[i]).stem();
    items.push_back(std::move(item));
  }
  Picture sheet;
  const Size cell = request->size.value_or(Size{320, 320});
  std::string problem = contact_sheet(items, request->columns.value_or(0), cell, sheet);
  if (problem.empty()) problem = write_png(sheet, request->files[0]);
  if (!problem.empty()) return io(problem);
  return std::string();
}

Service::Reply Service::movie(Words words) {
  auto request = parse_request(me_.world(), words, {"from", "size", "quality", "with", "rate"});
  if (!request) return request.error();
  if (request->files.size() != 1) {
    return Error{ErrorKind::syntax,
                 "expected one file or folder, or off: movie FILE.mp4 [from CAMERA] [size WxH] [rate HZ]",
                 words.empty() ? 1 : words.back().column};
  }
  if (request->files[0] == "off") {
    if (!movie_) return Error{ErrorKind::unknown, "no film is being made", words[0].column};
    // a film without time is one picture
    if (movie_->frames() == 0) film(1);
    if (!movie_) return io("the film could not be made");
    const std::string problem = movie_->finish();
    const std::string body =
        movie_->path() + ": " + std::to_string(movie_->frames()) + " frames, " + seconds(movie_->seconds()) + "\n";
    movie_.reset();
    if (!problem.empty()) return io(problem);
    return body;
  }
  if (movie_) return Error{ErrorKind::busy, movie_->path() + " is being made; say movie off first", words[0].column};
  const double rate = request->rate.value_or(std::min(1 / me_.hello().tick, 60.0));
  std::string problem;
  movie_ = Movie::start(request->files[0], size_of(*request), rate, now_, problem);
  if (!movie_) return io(problem);
  film_ = *request;
  film_.size = movie_->size();
  film_camera_ = film_.camera ? film_.camera->path : "";
  film_view_ = film_.view ? film_.view->path : "";
  return std::string();
}

Service::Reply Service::export_scene(Words words) {
  if (words.size() != 1 || !words[0].text.ends_with(".glb")) {
    return Error{ErrorKind::syntax, "expected one .glb file: export FILE.glb", words.empty() ? 1 : words.back().column};
  }
  Gltf gltf;
  gltf.moment(me_.world(), studio_.stage().compose(me_.world(), nullptr, now_), studio_.stage().skins(), now_);
  if (std::string problem = gltf.write(std::string(words[0].text)); !problem.empty()) return io(problem);
  return std::string();
}

Service::Reply Service::animate(Words words) {
  if (words.size() == 1 && words[0].text == "off") {
    if (!animation_) return Error{ErrorKind::unknown, "no movement is being recorded", words[0].column};
    const std::string problem = animation_->write(animation_file_);
    const std::string body = animation_file_ + ": " + std::to_string(animation_->moments()) + " moments\n";
    animation_.reset();
    if (!problem.empty()) return io(problem);
    return body;
  }
  if (words.size() != 1 || !words[0].text.ends_with(".glb")) {
    return Error{ErrorKind::syntax, "expected one .glb file, or off: animate FILE.glb",
                 words.empty() ? 1 : words.back().column};
  }
  if (animation_)
    return Error{ErrorKind::busy, animation_file_ + " is being recorded; say animate off first", words[0].column};
  animation_ = std::make_unique<Gltf>();
  animation_file_ = words[0].text;
  animation_->moment(me_.world(), studio_.stage().compose(me_.world(), nullptr, now_), studio_.stage().skins(), now_);
  return std::string();
}

Service::Reply Service::window(Words words) {
  auto request = parse_request(me_.world(), words, {"size", "with"});
  if (!request) return request.error();
  const std::string& wanted = request->files.size() == 1 ? request->files[0] : "";
  if (wanted != "on" && wanted != "off" && wanted != "refresh") {
    return Error{ErrorKind::syntax, "expected on, off or refresh: window on [size WxH] [with VIEW]",
                 words.empty() ? 1 : words.back().column};
  }
  if (wanted == "off") {
    window_.reset();
    speaker_.reset();
    if (request->view) me_.set_word(*request->view, "window", "off");
    return std::string();
  }
  if (wanted == "on") {
    window_.reset();
    speaker_ = std::make_unique<Speaker>();
    if (speaker_->path().empty()) return io("no FIFO can be made for the window to speak through");
    Speaker* voice = speaker_.get();
    // every line is followed by a look at the world, so that its effect is seen while the clock stands still
    auto say = [voice](const std::string& line) {
      voice->say(line);
      voice->say("window refresh");
    };
    std::string problem;
    window_ = Window::open(size_of(*request), say, problem);
    if (!window_) return io(problem);
    for (const auto& [event, command] : bindings_) window_->bind(event, command);
    window_view_ = request->view ? request->view->path : "";
    me_.say("listen " + speaker_->path());
  }
  if (!window_) return Error{ErrorKind::unknown, "no window is open", words[0].column};
  show();
  return std::string();
}

Service::Reply Service::bind(Words words) {
  if (words.size() < 2) {
    std::string body;
    if (words.empty()) {
      for (const auto& [event, command] : bindings_) body += event + " " + objdb::quote(command) + "\n";
      return body;
    }
    return Error{ErrorKind::syntax, "expected an event and a command: bind Key-space pause", words.back().column};
  }
  const std::string event(words[0].text);
  if (std::string problem = Bindings::event_problem(event); !problem.empty()) {
    return Error{ErrorKind::range, problem, words[0].column};
  }
  std::string command(words[1].text);
  for (const Word& word : words.subspan(2))
    command += " " + (word.quoted ? objdb::quote(word.text) : std::string(word.text));
  bindings_[event] = command;
  if (window_) window_->bind(event, command);
  return std::string();
}

Service::Reply Service::unbind(Words words) {
  if (words.size() != 1) {
    return Error{ErrorKind::syntax, "expected one event: unbind Key-space", words.empty() ? 1 : words.back().column};
  }
  const std::string event(words[0].text);
  if (bindings_.erase(event) == 0) {
    return Error{ErrorKind::unknown, objdb::shown(event) + " is not bound", words[0].column};
  }
  if (window_) window_->unbind(event);
  return std::string();
}

void Service::show() {
  if (!window_) return;
  const objdb::Database& world = me_.world();
  const Object* view = window_view_.empty() ? nullptr : world.find(window_view_);
  if (window_->state() != Window::State::open) {
    if (view) me_.set_word(*view, "window", window_->state() == Window::State::closed ? "closed" : "lost");
    window_.reset();
    me_.say("unlisten " + speaker_->path());
    speaker_.reset();
    return;
  }
  if (view) me_.set_word(*view, "window", "open");
  Shown shown;
  shown.scene = studio_.stage().compose(world, view, now_);
  const Object* camera = chosen_camera(world, view);
  shown.camera = camera ? camera_of(world, *camera) : camera_for(shown.scene, 16.0f / 9);
  Request request;
  request.view = view;
  shown.quality = quality_of(request);
  for (const Object* object : all_of(world, "shape")) {
    if (is_a(world, *object, "skin") || is_a(world, *object, "eyeball")) continue;
    Handle handle{object->path, Eigen::Isometry3d::Identity()};
    if (const Object* parent = world.object(world.scene().parent_of(*object))) handle.X_WP = frame_of(world, *parent);
    shown.handles.push_back(std::move(handle));
  }
  window_->show(std::move(shown));
}

void Service::follow_marks() {
  const objdb::Database& world = me_.world();
  for (const Object* mark : all_of(world, "mark")) {
    const Object* surface = object_of(world, *mark, "surface");
    Eigen::Vector3d travel = Eigen::Vector3d::Zero();
    for (const Object* face : all_of(world, "face")) {
      if (!surface || object_of(world, *face, "skin") != surface) continue;
      const objdb::Value* value = value_of(*face, "vertices");
      const auto* vertices = value ? std::get_if<std::vector<std::int64_t>>(value) : nullptr;
      const objdb::Numbers* by = numbers_of(*face, "displacement");
      if (!vertices || !by || by->size() != 3 * vertices->size()) continue;
      const auto found = std::find(vertices->begin(), vertices->end(), integer_of(*mark, "vertex"));
      if (found == vertices->end()) continue;
      travel += Eigen::Map<const Eigen::Vector3d>(by->data() + 3 * (found - vertices->begin()));
    }
    me_.set(*mark, "travel", travel.norm());
  }
}

void Service::tick(const kit::Tick& tick) {
  now_ = tick.time;
  follow_marks();
  studio_.stage().trails().record(me_.world(), now_);
  show();
  if (animation_)
    animation_->moment(me_.world(), studio_.stage().compose(me_.world(), nullptr, now_), studio_.stage().skins(), now_);
  if (!movie_) return;
  const int due = movie_->due(now_);
  if (due <= 0) return;
  film(due);
}

void Service::film(int frames) {
  film_.camera = film_camera_.empty() ? nullptr : me_.world().find(film_camera_);
  film_.view = film_view_.empty() ? nullptr : me_.world().find(film_view_);
  Picture picture;
  Outcome outcome = take(film_, now_, picture);
  std::string problem = outcome.status == "failed" ? outcome.reason : "";
  // slow ticks under a fast film repeat the frame, so that the film keeps its time
  for (int k = 0; k < frames && problem.empty(); ++k) {
    problem = movie_->add(picture);
    if (movie_->frames() % 300 == 0) {
      std::fprintf(stderr, "%s: %d frames, %s\n", movie_->path().c_str(), movie_->frames(),
                   seconds(movie_->seconds()).c_str());
    }
  }
  if (problem.empty()) return;
  // a film that cannot go on ends; the run goes on
  std::fprintf(stderr, "%s\n", problem.c_str());
  outcome.status = "failed";
  outcome.reason = problem;
  tell(film_, outcome);
  movie_.reset();
}

}  // namespace render
