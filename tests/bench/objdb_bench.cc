#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "objdb/statement.h"

/// What a line costs, against the plainest look-ups of the standard library in the same run, and what change costs in
/// worlds of any size. Process CPU time, the least of several rounds: other programs on the machine add to none of
/// them.
namespace {

using namespace objdb;

double now() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void require(bool good) {
  if (!good) std::abort();
}

// least time of `rounds` calls, in nanoseconds for each of `count` things
template <class F>
double least(int rounds, std::size_t count, F work) {
  double best = 1e9;
  for (int i = 0; i < rounds; ++i) {
    const double start = now();
    work();
    best = std::min(best, now() - start);
  }
  return best * 1e9 / static_cast<double>(count);
}

void say(Database& database, std::string_view text) {
  LineWords words;
  require(words.split(text).ok());
  const std::string_view verb = words.words()[0].text;
  const Words rest = words.words().subspan(1);
  if (verb == "type") require(database.declare_type(rest).ok());
  if (verb == "field") require(database.declare_field(rest).ok());
  if (verb == "create") require(create_statement(database, rest, {}).ok());
  if (verb == "set") require(set_statement(database, rest, {}).ok());
}

std::uint64_t sink = 0;

/// `fields` vec3 fields, ten an object, set by lines in random order.
void bench_sets(std::size_t fields, int each) {
  Database database;
  say(database, "type thing");
  for (int i = 0; i < each; ++i) say(database, "field thing.value_" + std::to_string(i) + " vec3 m in -1e9 1e9");
  std::vector<std::string> names;
  std::map<std::string, Vec3, std::less<>> ordered;
  std::unordered_map<std::string, Vec3> hashed;
  for (std::size_t i = 0; i < fields / static_cast<std::size_t>(each); ++i) {
    const std::string path = "object_" + std::to_string(i);
    say(database, "create thing " + path);
    for (int k = 0; k < each; ++k) names.push_back(path + ".value_" + std::to_string(k));
  }
  for (const std::string& name : names) ordered[name] = hashed[name] = {};

  // the same order of names for everyone; numbers as a simulation says them, with all their digits or with few
  std::mt19937_64 random(1);
  const std::size_t count = 400'000;
  std::vector<std::string> targets;
  std::string lines, short_lines;
  std::uniform_real_distribution<double> any(-1, 1);
  for (std::size_t i = 0; i < count; ++i) {
    targets.push_back(names[random() % names.size()]);
    lines += "set " + targets.back() + " " + number(any(random)) + " " + number(any(random)) + " " +
             number(any(random)) + "\n";
    short_lines += "set " + targets.back() + " " + number(static_cast<double>(random() % 100) / 4) + " 1.5 -0.25\n";
  }

  // as a reader does it: one buffer, cut at its newlines
  const auto for_each_line = [](std::string_view text, const auto& take) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      take(text.substr(0, end));
      text.remove_prefix(end + 1);
    }
  };
  LineWords words;
  const Scope scope;
  const auto run = [&](const std::string& script) {
    for_each_line(script, [&](std::string_view line) {
      require(words.split(line).ok());
      require(set_statement(database, words.words().subspan(1), scope).ok());
    });
  };
  const auto split_only = [&] {
    for_each_line(short_lines, [&](std::string_view line) {
      require(words.split(line).ok());
      sink += words.words().size();
    });
  };
  const auto look_up = [&](auto& map) {
    for (const std::string& name : targets) map.find(name)->second[0] += 1;
  };

  const int rounds = 5;
  const double set_short = least(rounds, count, [&] { run(short_lines); });
  const double set_long = least(rounds, count, [&] { run(lines); });
  const double split = least(rounds, count, split_only);
  const double tree = least(rounds, count, [&] { look_up(ordered); });
  const double table = least(rounds, count, [&] { look_up(hashed); });
  std::printf("%9zu %6d %9.0f %9.2f %9.0f %9.2f %8.0f %10.0f %14.0f\n", fields, each, set_short, 1e3 / set_short,
              set_long, 1e3 / set_long, split, tree, table);
}

/// 100 changes in a world of `objects` nodes: hash, feed, frames.
void bench_change(std::size_t objects) {
  Database database;
  const std::uint64_t feed = database.subscribe();
  for (std::size_t i = 0; i < objects; ++i)
    require(database.create(*database.schema().find("node"), "n" + std::to_string(i)).ok());
  database.keep_history(1000);
  const auto nobody = [](const Database::Event&, const Object&) {};
  database.read_feed(feed, nobody);
  sink += database.hash();
  for (std::size_t i = 1; i <= objects; ++i)
    sink += static_cast<std::uint64_t>(database.scene().world(*database.object(static_cast<ObjectId>(i))).p[0]);

  // the objects that change stand close together, so that the caches see as much of them in a small world as in a large
  // one
  const std::size_t changes = 100;
  double value = 0;
  double write = 1e9, hash = 1e9, read = 1e9, frames = 1e9, back = 1e9;
  for (int round = 0; round < 200; ++round) {
    const std::uint64_t mark = database.mark();
    value += 1;
    const double t0 = now();
    for (ObjectId i = 1; i <= changes; ++i)
      database.assign(*database.object(i), scene::Scene::position, Vec3{value, 0, 0});
    const double t1 = now();
    sink += database.hash();
    const double t2 = now();
    for (ObjectId i = 1; i <= changes; ++i)
      sink += static_cast<std::uint64_t>(database.scene().world(*database.object(i)).p[0]);
    const double t3 = now();
    database.read_feed(feed, nobody);
    const double t4 = now();
    database.roll_back(mark);
    const double t5 = now();
    database.read_feed(feed, nobody);
    for (ObjectId i = 1; i <= changes; ++i)
      sink += static_cast<std::uint64_t>(database.scene().world(*database.object(i)).p[0]);
    sink += database.hash();
    write = std::min(write, t1 - t0);
    hash = std::min(hash, t2 - t1);
    frames = std::min(frames, t3 - t2);
    read = std::min(read, t4 - t3);
    back = std::min(back, t5 - t4);
  }
  // one object made and deleted again
  double life = 1e9;
  for (int round = 0; round < 50; ++round) {
    const double start = now();
    const Result<ObjectId> id = database.create(*database.schema().find("node"), "guest");
    require(database.erase({*id}, false).ok());
    life = std::min(life, now() - start);
  }
  std::printf("%9zu %9.1f %9.1f %9.1f %9.1f %9.1f %12.1f\n", objects, write * 1e6, hash * 1e6, frames * 1e6, read * 1e6,
              back * 1e6, life * 1e6);
}

}  // namespace

int main() {
  std::printf("One line `set object.field x y z`, split and stored, fields in random order; ns of CPU time\n");
  std::printf("%9s %6s %9s %9s %9s %9s %8s %10s %14s\n", "fields", "each", "short ns", "M/s", "17 digits", "M/s",
              "split", "std::map", "unordered_map");
  for (const std::size_t fields : {100, 1'000, 10'000, 100'000}) bench_sets(fields, 10);
  bench_sets(100'000, 1);

  std::printf("\n100 changed nodes in a world of nodes; microseconds of CPU time for all 100\n");
  std::printf("%9s %9s %9s %9s %9s %9s %12s\n", "nodes", "write", "hash", "frames", "feed", "undo", "make, delete");
  for (const std::size_t objects : {100, 1'000, 10'000, 100'000, 1'000'000}) bench_change(objects);
  return sink == 42 ? 1 : 0;
}
