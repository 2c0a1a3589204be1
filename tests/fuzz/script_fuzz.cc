#include <cstdio>
#include <cstdlib>
#include <optional>

#include "tests/objdb/world.h"

namespace {

using namespace objdb;

void require(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace

/// Any text as a script, and what must hold of whatever world it makes. Besides the verbs of objdb, `tick` lets a
/// mirror follow, `back` takes back the last command, `again` does it again.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  World world;
  std::optional<World> mirror;
  Database& database = world.database;
  database.keep_history(1'000'000);
  const Database::FeedId feed = database.subscribe();
  std::vector<std::uint64_t> marks;
  std::vector<Database::Change> redo;

  const auto follow = [&] {
    if (!mirror) mirror.emplace();
    std::string lines;
    // types and fields first, then what the feed says
    for (const auto& type : database.schema().types())
      if (!database.schema().is_built_in(*type))
        lines += "type " + type->name() + (type->base() == nullptr ? "" : " extends " + type->base()->name()) + "\n";
    for (const auto& type : database.schema().types())
      for (const Field* field : type->fields())
        if (field->owner == type.get() && !field->derived) lines += field->declaration() + "\n";
    database.read_feed(feed, [&](const Database::Event& event, const Object& object) {
      if (event.field == Database::Event::deleted)
        lines += "delete " + object.path + " force\n";
      else if (event.field == Database::Event::created)
        append_create(lines, database, object, [](const Object&, const Field&) { return true; });
      else if (!object.type->field(event.field).derived)
        append_set(lines, database, object, event.field);
    });
    const std::string told = mirror->read(lines);
    if (!told.empty()) std::fprintf(stderr, "%s\n", told.c_str());
    require(told.empty(), "a mirror can follow");
    require(mirror->database.hash() == database.hash(), "a mirror is the same");
  };

  std::string_view script(reinterpret_cast<const char*>(data), size);
  while (!script.empty()) {
    const std::size_t end = script.find('\n');
    const std::string_view line = script.substr(0, end);
    script.remove_prefix(end == std::string_view::npos ? script.size() : end + 1);
    if (line == "tick") {
      follow();
    } else if (line == "back" && !marks.empty()) {
      redo.clear();
      database.roll_back(marks.back(), &redo);
      marks.pop_back();
    } else if (line == "again") {
      marks.push_back(database.mark());
      database.roll_forward(redo);
    } else {
      const std::uint64_t mark = database.mark(), before = database.hash();
      const std::string told = world.say(line);
      require(is_text(told) && told.find('\n') == std::string::npos && told.size() < 2000,
              "a sentence is one short line");
      if (told.empty()) {
        marks.push_back(mark);
        redo.clear();
      } else {
        require(database.hash() == before, "what is refused changes nothing");
      }
    }
  }
  if (mirror) follow();
  const std::string values = world.everything();
  require(values.find(" nan") == std::string::npos && values.find(" inf") == std::string::npos &&
              values.find("-nan") == std::string::npos && values.find("-inf") == std::string::npos,
          "every number is finite");

  World other;
  const std::string told = other.read(save(database));
  if (!told.empty()) std::fprintf(stderr, "%s\n", told.c_str());
  require(told.empty(), "a saved world can be read");
  require(other.database.hash() == database.hash(), "a saved world is the same");

  database.roll_back(database.oldest_mark());
  require(database.size() == 0 && database.hash() == 0, "everything can be taken back");
  if (mirror) follow();
  return 0;
}
