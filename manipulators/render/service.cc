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

void Service::tick(const kit::Tick& tick) {
  now_ = tick.time;
  studio_.stage().trails().record(me_.world(), now_);
  if (!movie_) return;
  const int due = movie_->due(now_);
  if (due <= 0) return;
  film_.camera = film_camera_.empty() ? nullptr : me_.world().find(film_camera_);
  film_.view = film_view_.empty() ? nullptr : me_.world().find(film_view_);
  Picture picture;
  Outcome outcome = take(film_, now_, picture);
  std::string problem = outcome.status == "failed" ? outcome.reason : "";
  // slow ticks under a fast film repeat the frame, so that the film keeps its time
  for (int k = 0; k < due && problem.empty(); ++k) {
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
