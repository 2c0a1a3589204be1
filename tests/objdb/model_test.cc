#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/objdb/world.h"

/// Random sessions against a world that is only a map of texts: what is accepted, what is refused and why, what every
/// value is afterwards; and everything that must hold at any moment: the same hash after saving and reading back, in
/// every mirror that follows a feed, after taking back and doing again; world transforms as computed by quaternions.
namespace objdb {
namespace {

constexpr std::string_view schema = R"(type thing
field thing.note text
field thing.level int = 3 in 0 9
field thing.link ref
field thing.links ref:node[]
field thing.samples real[]
field thing.figure real measured
field thing.secret vec3 private
type wheel extends joint
field wheel.spin real rad
)";

// the plainest description of a world
struct Plain {
  struct Entry {
    std::string type;
    std::map<std::string, std::string> values;  // by field, as printed
  };
  std::map<std::string, Entry> objects;  // by path

  static bool is_node(const std::string& type) { return type != "thing"; }
  static std::string above(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? "" : path.substr(0, slash);
  }

  // the node it moves with, "" at the top
  std::string carrier(const std::string& path) const {
    if (const std::string& parent = objects.at(path).values.at("parent"); parent != "-") return parent;
    for (std::string each = above(path); !each.empty(); each = above(each))
      if (is_node(objects.at(each).type)) return each;
    return "";
  }

  bool carries(const std::string& upper, std::string lower) const {
    for (; !lower.empty(); lower = carrier(lower))
      if (lower == upper) return true;
    return false;
  }

  static std::vector<std::string> words(const std::string& text) {
    std::vector<std::string> out;
    std::string word;
    for (const char c : text + " ") {
      if (c != ' ') {
        word += c;
        continue;
      }
      out.push_back(word);
      word.clear();
    }
    return out;
  }
};

using Q = std::array<double, 4>;

Q product(const Q& a, const Q& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Vec3 turned(const Q& q, const Vec3& v) {
  const Q out = product(product(q, {0, v[0], v[1], v[2]}), {q[0], -q[1], -q[2], -q[3]});
  return {out[1], out[2], out[3]};
}

struct Pose {
  Q q{1, 0, 0, 0};
  Vec3 p{0, 0, 0};
};

Pose operator*(const Pose& a, const Pose& b) {
  const Vec3 carried = turned(a.q, b.p);
  return {product(a.q, b.q), {a.p[0] + carried[0], a.p[1] + carried[1], a.p[2] + carried[2]}};
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> out;
  for (const std::string& word : Plain::words(text)) out.push_back(std::stod(word));
  return out;
}

Pose world_pose(const Plain& plain, const std::string& path) {
  const auto& values = plain.objects.at(path).values;
  const auto p = numbers(values.at("position")), q = numbers(values.at("orientation"));
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  Pose pose{{q[0] / length, q[1] / length, q[2] / length, q[3] / length}, {p[0], p[1], p[2]}};
  if (values.count("dh") != 0) {
    const auto dh = numbers(values.at("dh"));
    const double theta = dh[0] + std::stod(values.at("angle")), alpha = dh[3];
    pose = pose * Pose{{std::cos(theta / 2), 0, 0, std::sin(theta / 2)}, {0, 0, dh[1]}} *
           Pose{{std::cos(alpha / 2), std::sin(alpha / 2), 0, 0}, {dh[2], 0, 0}};
    // the step along x comes before the turn about it: Tx(a) Rx(alpha) has p = (a, 0, 0) in the frame of Rz
  }
  const std::string carrier = plain.carrier(path);
  return carrier.empty() ? pose : world_pose(plain, carrier) * pose;
}

// follows a feed by lines, as a manipulator does
struct Mirror {
  World world;
  Database::FeedId feed = 0;

  void begin(Database& source) {
    ASSERT_EQ(world.read(save(source)), "");
    feed = source.subscribe();
  }

  void follow(Database& source) {
    std::string lines;
    source.read_feed(feed, [&](const Database::Event& event, const Object& object) {
      if (event.field == Database::Event::deleted) {
        lines += "delete " + object.path + " force\n";
      } else if (event.field == Database::Event::created) {
        append_create(lines, source, object, [](const Object&, const Field&) { return true; });
      } else if (!object.type->field(event.field).derived) {
        append_set(lines, source, object, event.field);
      }
    });
    ASSERT_EQ(world.read(lines), "") << lines;
  }
};

class Session {
 public:
  explicit Session(std::uint64_t seed) : random_(seed) { EXPECT_EQ(world_.read(schema), ""); }

  Database& database() { return world_.database; }
  const Plain& plain() const { return plain_; }
  World& world() { return world_; }
  std::uint64_t draw(std::uint64_t below) { return random_() % below; }

  // one random command, said to the world and to the map
  void command() {
    switch (draw(10)) {
      case 0:
      case 1: return create();
      case 2: return erase();
      case 3:
      case 4: return hang();
      case 5: return refer();
      default: return set_value();
    }
  }

  // the world and the map say the same
  void compare() {
    ASSERT_EQ(database().size(), plain_.objects.size());
    for (const auto& [path, entry] : plain_.objects) {
      const Object* object = database().find(path);
      ASSERT_NE(object, nullptr) << path;
      ASSERT_EQ(object->type->name(), entry.type);
      for (const auto& [field, value] : entry.values)
        ASSERT_EQ(world_.get(path + "." + field), value) << path << "." << field;
    }
  }

  void compare_frames() {
    for (const auto& [path, entry] : plain_.objects) {
      if (!Plain::is_node(entry.type)) continue;
      const Object& object = *database().find(path);
      const Pose expected = world_pose(plain_, path);
      const scene::Transform& got = database().scene().world(object);
      // some 1e-16 a step of the chain on lengths of a few metres; chains have less than fifty steps
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_NEAR(got.p[i], expected.p[i], 1e-11) << path;
        Vec3 axis{0, 0, 0};
        axis[i] = 1;
        const Vec3 column = turned(expected.q, axis);
        for (std::size_t j = 0; j < 3; ++j) ASSERT_NEAR(got.R[j][i], column[j], 1e-12) << path;
      }
    }
  }

  // what the database keeps in step by hand, counted anew
  void compare_counts() {
    std::map<ObjectId, std::uint32_t> referrers;
    std::map<ObjectId, std::vector<ObjectId>> children, carried;
    database().for_each("**", [&](const Object& object) {
      if (object.parent != 0) children[object.parent].push_back(object.id);
      if (object.place) {
        const std::string carrier = plain_.carrier(object.path);
        const ObjectId id = carrier.empty() ? 0 : database().find(carrier)->id;
        ASSERT_EQ(object.place->parent, id) << object.path;
        if (id != 0) carried[id].push_back(object.id);
      }
      for (std::size_t i = 0; i < object.slots.size(); ++i) {
        if (!object.type->fields()[i]->holds_refs()) continue;
        if (const auto* one = std::get_if<std::int64_t>(&object.slots[i].value)) {
          if (*one != 0) ++referrers[static_cast<ObjectId>(*one)];
        } else {
          for (const std::int64_t each : std::get<std::vector<std::int64_t>>(object.slots[i].value))
            if (each != 0) ++referrers[static_cast<ObjectId>(each)];
        }
      }
    });
    database().for_each("**", [&](const Object& object) {
      ASSERT_EQ(object.referrers, referrers[object.id]) << object.path;
      ASSERT_EQ(object.children, children[object.id]) << object.path;
      if (object.place) {
        ASSERT_EQ(object.place->children, carried[object.id]) << object.path;
      }
    });
  }

  void restore(const Plain& plain) { plain_ = plain; }

  int broken_circles = 0;

 private:
  std::string any_path() {
    if (plain_.objects.empty()) return "nobody";
    auto at = plain_.objects.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(draw(plain_.objects.size())));
    return at->first;
  }

  std::string real() { return number(static_cast<double>(draw(2001)) / 1000 - 1); }

  void expect(const std::string& line, const std::string& kind) {
    const std::string told = world_.say(line);
    ASSERT_EQ(told.substr(0, told.find(' ')), kind) << line << " -> " << told;
  }

  void create() {
    std::string path(1, static_cast<char>('a' + draw(6)));
    if (draw(3) != 0 && !plain_.objects.empty()) path = any_path() + "/" + path;
    if (std::count(path.begin(), path.end(), '/') > 4) return;
    const std::string type = std::array{"node", "thing", "joint", "wheel", "sphere"}[draw(5)];
    const std::string above = Plain::above(path);
    std::string kind;
    if (plain_.objects.count(path) != 0)
      kind = "exists";
    else if (!above.empty() && plain_.objects.count(above) == 0)
      kind = "unknown";
    Plain::Entry entry{type, {}};
    std::string line = "create " + type + " " + path;
    if (Plain::is_node(type)) {
      entry.values = {{"parent", "-"}, {"position", "0 0 0"}, {"orientation", "1 0 0 0"}, {"visible", "true"}};
      if (type == "joint" || type == "wheel") entry.values.insert({{"dh", "0 0 0 0"}, {"angle", "0"}});
      if (draw(2) == 0) line += " position " + (entry.values["position"] = real() + " " + real() + " " + real());
      if (draw(4) == 0 && !plain_.objects.empty()) {
        const std::string other = any_path();
        if (Plain::is_node(plain_.objects[other].type)) line += " parent " + (entry.values["parent"] = other);
      }
    } else {
      entry.values = {{"note", "\"\""}, {"level", "3"},  {"link", "-"},      {"links", "-"},
                      {"samples", "-"}, {"figure", "0"}, {"secret", "0 0 0"}};
      if (draw(2) == 0) line += " level " + (entry.values["level"] = std::to_string(draw(10)));
    }
    expect(line, kind);
    if (kind.empty()) plain_.objects[path] = entry;
  }

  void erase() {
    const std::string path = any_path();
    const bool force = draw(2) == 0;
    std::string kind;
    if (plain_.objects.count(path) == 0) return expect("delete " + path, "unknown");
    const auto doomed = [&](const std::string& each) { return each == path || each.starts_with(path + "/"); };
    for (auto& [name, entry] : plain_.objects) {
      if (doomed(name)) continue;
      for (const char* field : {"parent", "link", "links"}) {
        if (entry.values.count(field) == 0) continue;
        for (const std::string& word : Plain::words(entry.values[field]))
          if (doomed(word)) kind = force ? "" : "busy";
      }
    }
    expect("delete " + path + (force ? " force" : ""), kind);
    if (!kind.empty()) return;
    std::erase_if(plain_.objects, [&](const auto& each) { return doomed(each.first); });
    for (auto& [name, entry] : plain_.objects)
      for (const char* field : {"parent", "link", "links"}) {
        if (entry.values.count(field) == 0) continue;
        std::string left;
        for (const std::string& word : Plain::words(entry.values[field]))
          left += (left.empty() ? "" : " ") + (!doomed(word)                        ? word
                                               : std::string_view(field) == "links" ? "\"\""
                                                                                    : "-");
        entry.values[field] = left;
      }
    if (has_circle()) adopt_broken_circle();
  }

  bool has_circle() const {
    for (const auto& [path, entry] : plain_.objects) {
      if (!Plain::is_node(entry.type)) continue;
      std::string each = path;
      for (std::size_t steps = 0; !each.empty(); each = plain_.carrier(each))
        if (++steps > plain_.objects.size()) return true;
    }
    return false;
  }

  // emptied references may leave a node below one that it carries: then more of them must have been emptied
  void adopt_broken_circle() {
    ++broken_circles;
    for (auto& [path, entry] : plain_.objects) {
      if (!Plain::is_node(entry.type)) continue;
      const std::string parent = world_.get(path + ".parent");
      if (parent != entry.values["parent"]) {
        ASSERT_EQ(parent, "-") << path;
      }
      entry.values["parent"] = parent;
    }
    ASSERT_FALSE(has_circle());
  }

  void hang() {
    const std::string path = any_path(), other = draw(5) == 0 ? "-" : any_path();
    if (plain_.objects.empty()) return;
    std::string kind;
    if (!Plain::is_node(plain_.objects[path].type)) {
      kind = "unknown";
    } else if (other != "-" && !Plain::is_node(plain_.objects[other].type)) {
      kind = "type";
    } else if (other != "-" && plain_.carries(path, other)) {
      kind = "range";
    } else if (other == "-") {
      // the node above it in its path may be one that it carries
      const std::string old = plain_.objects[path].values["parent"];
      plain_.objects[path].values["parent"] = "-";
      const std::string carrier = plain_.carrier(path);
      plain_.objects[path].values["parent"] = old;
      if (!carrier.empty() && plain_.carries(path, carrier)) kind = "range";
    }
    expect("set " + path + ".parent " + other, kind);
    if (kind.empty()) plain_.objects[path].values["parent"] = other;
  }

  void refer() {
    const std::string path = any_path(), other = any_path();
    if (plain_.objects.empty() || plain_.objects[path].type != "thing") return;
    auto& values = plain_.objects[path].values;
    if (draw(2) == 0) {
      expect("set " + path + ".link " + other, "");
      values["link"] = other;
      return;
    }
    std::string list, kind;
    for (std::uint64_t n = draw(4); n > 0; --n) {
      const std::string each = any_path();
      if (!Plain::is_node(plain_.objects[each].type)) kind = "type";
      list += (list.empty() ? "" : " ") + each;
    }
    if (list.empty()) list = "-";
    expect("set " + path + ".links " + list, kind);
    if (kind.empty()) values["links"] = list;
  }

  void set_value() {
    const std::string path = any_path();
    if (plain_.objects.empty()) return;
    auto& [type, values] = plain_.objects[path];
    std::string field, value;
    if (type == "thing") {
      switch (draw(5)) {
        case 0: field = "note", value = quote(std::string(draw(4), ' ') + "x\"" + real()); break;
        case 1: field = "level", value = std::to_string(draw(10)); break;
        case 2: field = "samples", value = real() + " " + real(); break;
        case 3: field = "figure", value = real(); break;
        default: field = "secret", value = real() + " " + real() + " " + real();
      }
    } else {
      switch (draw(values.count("dh") != 0 ? 5 : 3)) {
        case 0: field = "position", value = real() + " " + real() + " " + real(); break;
        case 1: field = "orientation", value = "1 " + real() + " " + real() + " " + real(); break;
        case 2: field = "visible", value = draw(2) == 0 ? "false" : "true"; break;
        case 3: field = "angle", value = real(); break;
        default: field = "dh", value = real() + " " + real() + " " + real() + " " + real();
      }
    }
    expect("set " + path + "." + field + " " + value, "");
    values[field] = value;
  }

  World world_;
  Plain plain_;
  std::mt19937_64 random_;
};

std::string sorted_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    lines.push_back(text.substr(at, text.find('\n', at) - at));
  std::sort(lines.begin(), lines.end());
  std::string out;
  for (const std::string& line : lines)
    if (line.find(".figure ") == std::string::npos) out += line + '\n';
  return out;
}

void expect_same_after_reading_back(Session& session) {
  World other;
  ASSERT_EQ(other.read(save(session.database())), "");
  ASSERT_EQ(other.database.hash(), session.database().hash());
  ASSERT_EQ(sorted_lines(other.everything()), sorted_lines(session.world().everything()));
}

void say_everything(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Session session(seed);
    for (int i = 0; i < 400; ++i) {
      session.command();
      if (i % 20 == 0) session.compare();
      if (testing::Test::HasFatalFailure()) return;
    }
    session.compare();
    session.compare_counts();
    session.compare_frames();
    expect_same_after_reading_back(session);
    if (testing::Test::HasFatalFailure()) return;
  }
}

void edit_frames(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Session session(seed);
    session.database().keep_history(1000);
    std::vector<std::pair<std::uint64_t, Plain>> marks;
    for (int i = 0; i < 300; ++i) {
      marks.emplace_back(session.database().mark(), session.plain());
      session.command();
      if (session.draw(20) == 0) {
        // a few steps back, while some frames are known and some are not
        const std::size_t back = marks.size() - 1 - session.draw(std::min<std::size_t>(marks.size(), 10));
        session.database().roll_back(marks[back].first);
        session.restore(marks[back].second);
        marks.resize(back);
      }
      if (session.draw(3) == 0) session.compare_frames();
      if (testing::Test::HasFatalFailure()) return;
    }
    session.compare_counts();
  }
}

void take_back(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Session session(seed);
    Database& database = session.database();
    database.keep_history(100'000);
    for (int round = 0; round < 20; ++round) {
      for (std::uint64_t n = session.draw(20); n > 0; --n) session.command();
      const std::uint64_t mark = database.mark(), hash = database.hash();
      const std::string before = session.world().everything();
      for (std::uint64_t n = session.draw(30); n > 0; --n) session.command();
      // a new field in between stays, also for what was deleted meanwhile
      if (round == 10) {
        ASSERT_EQ(session.world().say("field thing.late int measured"), "");
      }
      const std::uint64_t hash_after = database.hash();
      const std::string after = session.world().everything();
      std::vector<Database::Change> redo;
      database.roll_back(mark, &redo);
      ASSERT_EQ(database.mark(), mark);
      ASSERT_EQ(database.hash(), hash);
      if (round != 10) {
        ASSERT_EQ(session.world().everything(), before);
      }
      session.world().everything();
      database.roll_forward(redo);
      ASSERT_EQ(database.hash(), hash_after);
      ASSERT_EQ(session.world().everything(), after);
      if (round % 5 == 0) {
        session.compare();
        session.compare_counts();
        session.compare_frames();
        expect_same_after_reading_back(session);
      }
      if (testing::Test::HasFatalFailure()) return;
    }
    // and back to the beginning
    database.roll_back(database.oldest_mark());
    ASSERT_EQ(database.size(), 0u);
    ASSERT_EQ(database.hash(), 0u);
  }
}

void follow(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Session session(seed);
    Database& database = session.database();
    database.keep_history(100'000);
    // one that follows every command, one that sleeps long, one that comes late and leaves
    Mirror prompt, lazy;
    std::unique_ptr<Mirror> guest;
    prompt.begin(database);
    lazy.begin(database);
    std::vector<std::pair<std::uint64_t, Plain>> marks;
    for (int i = 0; i < 400; ++i) {
      marks.emplace_back(database.mark(), session.plain());
      session.command();
      if (session.draw(15) == 0) {
        const std::size_t back = marks.size() - 1 - session.draw(std::min<std::size_t>(marks.size(), 25));
        database.roll_back(marks[back].first);
        session.restore(marks[back].second);
        marks.resize(back);
      }
      // looking at frames makes derived events
      if (session.draw(4) == 0) session.world().everything();
      prompt.follow(database);
      if (session.draw(30) == 0) lazy.follow(database);
      if (session.draw(40) == 0) {
        if (guest) {
          database.unsubscribe(guest->feed);
          guest.reset();
        } else {
          guest = std::make_unique<Mirror>();
          guest->begin(database);
        }
      }
      if (guest && session.draw(6) == 0) {
        guest->follow(database);
        ASSERT_EQ(guest->world.database.hash(), database.hash()) << "seed " << seed << " command " << i;
      }
      ASSERT_EQ(prompt.world.database.hash(), database.hash()) << "seed " << seed << " command " << i;
      if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << " command " << i;
    }
    lazy.follow(database);
    ASSERT_EQ(lazy.world.database.hash(), database.hash());
    ASSERT_EQ(sorted_lines(lazy.world.everything()), sorted_lines(session.world().everything()));
    EXPECT_FALSE(database.has_events(lazy.feed));
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(Model, EveryCommandDoesWhatItSays) { say_everything(20); }
TEST(Model, FramesAreRightAfterEveryEdit) { edit_frames(10); }
TEST(Model, HistoryBringsBackTheVerySameWorld) { take_back(20); }
TEST(Model, MirrorsFollowTheFeed) { follow(30); }

// the same with more sessions
TEST(SlowModel, EveryCommandDoesWhatItSays) { say_everything(600); }
TEST(SlowModel, FramesAreRightAfterEveryEdit) { edit_frames(300); }
TEST(SlowModel, HistoryBringsBackTheVerySameWorld) { take_back(400); }
TEST(SlowModel, MirrorsFollowTheFeed) { follow(500); }

}  // namespace
}  // namespace objdb
