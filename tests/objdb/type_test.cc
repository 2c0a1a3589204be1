#include "objdb/type.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/objdb/world.h"

namespace objdb {
namespace {

// reads a declaration's own text into another schema: must be known there as the very same field
void expect_reads_back(const Field& field) {
  World other;
  const std::string owner = field.owner->name();
  if (other.database.schema().find(owner) == nullptr) {
    ASSERT_EQ(other.say("type " + owner), "");
  }
  if (field.ref_type != nullptr && other.database.schema().find(field.ref_type->name()) == nullptr) {
    ASSERT_EQ(other.say("type " + field.ref_type->name()), "");
  }
  const std::string line = field.declaration();
  ASSERT_LT(line.size(), longest_line);
  if (field.derived) return;
  ASSERT_EQ(other.say(line), "") << line.substr(0, 300);
  const Type& type = *other.database.schema().find(owner);
  const Field& again = type.field(type.find(field.name));
  EXPECT_EQ(again.declaration(), line);
  EXPECT_TRUE(same_bits(again.standard, field.standard)) << line.substr(0, 300);
  EXPECT_EQ(again.low, field.low);
  EXPECT_EQ(again.high, field.high);
  EXPECT_EQ(again.unit(), field.unit());
  EXPECT_EQ(again.words, field.words);
  EXPECT_EQ(again.doc, field.doc);
  EXPECT_EQ(again.is_private, field.is_private);
  EXPECT_EQ(again.measured, field.measured);
}

const Field& field_of(const World& world, std::string_view type, std::string_view name) {
  const Type& found = *world.database.schema().find(type);
  return found.field(found.find(name));
}

TEST(BuiltIn, TypesAreAllThere) {
  World world;
  for (const char* name :
       {"node", "joint", "shape", "sphere", "box", "cylinder", "capsule", "mesh", "camera", "light"}) {
    const Type* type = world.database.schema().find(name);
    ASSERT_NE(type, nullptr) << name;
    EXPECT_TRUE(world.database.schema().is_built_in(*type));
    EXPECT_TRUE(type->is(*world.database.schema().find("node")));
    EXPECT_FALSE(type->doc().empty());
    for (const Field* field : type->fields()) {
      EXPECT_FALSE(field->doc.empty()) << name << "." << field->name;
      EXPECT_TRUE(check_value(*field, field->standard).ok()) << name << "." << field->name;
    }
    ASSERT_EQ(world.say(std::string("create ") + name + " a_" + name), "");
  }
}

TEST(BuiltIn, FieldsCanBeDeclaredAgain) {
  World world;
  const std::uint64_t before = world.database.schema().hash();
  for (const auto& type : world.database.schema().types())
    for (const Field* field : type->fields())
      if (field->owner == type.get() && !field->derived) {
        EXPECT_EQ(world.say(field->declaration()), "");
      }
  EXPECT_EQ(world.database.schema().hash(), before);
}

// all kinds, shapes, units, ranges and marks in all combinations that are legal
TEST(Field, DeclarationReadsBack) {
  struct Form {
    std::string_view kind, extra, standard;
  };
  const Form forms[] = {{"bool", "", "true"},
                        {"int", "", "-7"},
                        {"int", " in -10 10", "3"},
                        {"real", "", "0.1"},
                        {"real", " cm in 1 7", "7"},
                        {"real", " deg in -90 90", "30deg"},
                        {"vec3", " mm", "1 2cm 3"},
                        {"vec3", " in 0 1", "0.1 0.2 0.3"},
                        {"quat", "", "0 1 0 0"},
                        {"word", " of left right -x 7", "right"},
                        {"text", "", "\"two words\""},
                        {"text", "", "\"= in # @ \\\\ \\n\""},
                        {"ref", "", ""},
                        {"ref:node", "", ""},
                        {"ref:t", "", ""}};
  int number_of_fields = 0;
  for (const Form& form : forms)
    for (const int count : {1, 2, 3, 70, 0})
      for (const bool given : {false, true})
        for (const char* mark : {"", " private", " measured"})
          for (const char* doc : {"", " \"what it is\"", " \"private\"", " \"x\""}) {
            if (given && form.standard.empty()) continue;
            World world;
            ASSERT_EQ(world.say("type t"), "");
            std::string line = "field t.f " + std::string(form.kind);
            if (count != 1) line += count == 0 ? "[]" : "[" + std::to_string(count) + "]";
            line += form.extra;
            if (given) {
              line += " =";
              for (int i = 0; i < std::max(count, 1); ++i) line += " " + std::string(form.standard);
            }
            line += std::string(mark) + doc;
            const std::string told = world.say(line);
            if (given && count == 0 && form.kind == "text") {
              EXPECT_NE(told, "") << line << ": a quoted word after an open list is the doc";
              continue;
            }
            ASSERT_EQ(told, "") << line;
            expect_reads_back(field_of(world, "t", "f"));
            ++number_of_fields;
          }
  EXPECT_GT(number_of_fields, 1000);
}

TEST(Field, BareNumbersOfADeclarationAreInItsUnit) {
  World world;
  ASSERT_EQ(world.read("type t\n"
                       "field t.a real cm = 7 in 1 100\n"
                       "field t.b real deg = 30deg in -1rad 90\n"
                       "field t.c real[2] deg,cm = 180 50\n"
                       "field t.d vec3[2] deg,cm = 180 180 180 50 50 50\n"
                       "field t.e real % = 50\n"),
            "");
  const auto text = [&](std::string_view name) { ASSERT_EQ(world.say("create t o_" + std::string(name)), ""); };
  text("x");
  EXPECT_EQ(world.get("o_x.a"), "0.07");
  EXPECT_EQ(field_of(world, "t", "a").high, 1);
  EXPECT_EQ(world.get("o_x.b"), "0.5235987755982988");
  EXPECT_EQ(field_of(world, "t", "b").low, -1);
  EXPECT_EQ(world.get("o_x.c"), "3.141592653589793 0.5");
  EXPECT_EQ(world.get("o_x.d"), "3.141592653589793 3.141592653589793 3.141592653589793 0.5 0.5 0.5");
  EXPECT_EQ(world.get("o_x.e"), "0.5");
  // elsewhere a bare number is SI, and each element has its own unit
  EXPECT_EQ(world.say("set o_x.c 90deg 5cm"), "");
  EXPECT_EQ(world.get("o_x.c"), "1.5707963267948966 0.05");
  EXPECT_EQ(world.say("set o_x.c 1m 1rad").substr(0, 4), "unit");
  EXPECT_EQ(world.say("set o_x.c[1] 7cm"), "");
  EXPECT_EQ(world.get("o_x.c"), "1.5707963267948966 0.07");
  EXPECT_EQ(world.say("set o_x.c[1] 7deg").substr(0, 4), "unit");
  for (const char* field : {"a", "b", "c", "d", "e"}) expect_reads_back(field_of(world, "t", field));
}

TEST(Field, WithoutDefaultIsWithinItsRange) {
  World world;
  ASSERT_EQ(world.read("type t\n"
                       "field t.a real in 2 3\nfield t.b vec3 in -3 -2\nfield t.c int in 1.5 3.5\n"
                       "field t.d real[3] in 1 2\nfield t.e int[2] in -9 -8.5\nfield t.f real in -1 1\nfield t.g int "
                       "in -1e300 1e300\n"
                       "create t o\n"),
            "");
  EXPECT_EQ(world.get("o.a"), "2");
  EXPECT_EQ(world.get("o.b"), "-2 -2 -2");
  EXPECT_EQ(world.get("o.c"), "2");
  EXPECT_EQ(world.get("o.d"), "1 1 1");
  EXPECT_EQ(world.get("o.e"), "-9 -9");
  EXPECT_EQ(world.get("o.f"), "0");
  EXPECT_EQ(world.get("o.g"), "0");
  for (const char* field : {"a", "b", "c", "d", "e", "f", "g"}) {
    const Field& declared = field_of(world, "t", field);
    EXPECT_TRUE(check_value(declared, declared.standard).ok()) << field;
    expect_reads_back(declared);
  }
}

struct Refused {
  std::string line, told;  // kind and column
};

TEST(Declaration, IsRefusedWithKindAndColumn) {
  const Refused refused[] = {
      {"type", "syntax 0"},
      {"type 1a", "syntax 6"},
      {"type \"a\"", "syntax 6"},
      {"type a/b", "syntax 6"},
      {"type a extends", "syntax 8"},
      {"type a extends nodes", "unknown 16"},
      {"type a extends node extends node", "syntax 21"},
      {"type a \"doc\" more", "syntax 14"},
      {"type node extends sphere", "exists 6"},
      {"type " + std::string(256, 'a'), "limit 6"},
      {"field", "syntax 0"},
      {"field t.a", "syntax 7"},
      {"field t real", "syntax 7"},
      {"field u.a real", "unknown 7"},
      {"field t.1 real", "syntax 7"},
      {"field t. real", "syntax 7"},
      {"field t." + std::string(256, 'a') + " real", "limit 7"},
      {"field t.a float", "type 11"},
      {"field t.a real[", "syntax 11"},
      {"field t.a real[0]", "syntax 11"},
      {"field t.a real[-1]", "syntax 11"},
      {"field t.a real[1000001]", "syntax 11"},
      {"field t.a real[99999999999999999999]", "syntax 11"},
      {"field t.a real[1]x", "syntax 11"},
      {"field t.a real[2][2]", "syntax 11"},
      {"field t.a ref:nod", "unknown 15"},
      {"field t.a ref:", "syntax 15"},
      {"field t.a real parsec", "unit 16"},
      {"field t.a real m kg", "syntax 18"},
      {"field t.a text m", "unit 16"},
      {"field t.a real[2] m,kg,s", "unit 19"},
      {"field t.a real[] m,kg", "unit 18"},
      {"field t.a vec3 m,m,m", "unit 16"},
      {"field t.a real in 1", "syntax 16"},
      {"field t.a real in 2 1", "range 19"},
      {"field t.a real in a b", "type 19"},
      {"field t.a real in nan 1", "type 19"},
      {"field t.a text in 1 2", "type 16"},
      {"field t.a quat in 1 2", "type 16"},
      {"field t.a int in 0.1 0.9", "range 18"},
      {"field t.a int in 1e300 1e301", "range 18"},
      {"field t.a real m in 1kg 2", "unit 21"},
      {"field t.a real of a b", "type 16"},
      {"field t.a word", "syntax 11"},
      {"field t.a word of", "syntax 16"},
      {"field t.a word of a b a", "exists 23"},
      {"field t.a word of a = b", "type 23"},
      {"field t.a real =", "syntax 16"},
      {"field t.a vec3 = 1 2", "syntax 16"},
      {"field t.a real = 1 = 2", "syntax 20"},
      {"field t.a real in 0 1 = 2", "range 25"},
      {"field t.a quat = 0 0 0 0", "range 18"},
      {"field t.a quat[2] = 1 0 0 0 0 0 0 0", "range 29"},
      {"field t.a ref = x", "type 17"},
      {"field t.a real \"doc\" \"again\"", "syntax 22"},
      {"field t.a real derived", "syntax 7"},
      {"field t.a text[] = @a b", "syntax 20"},
      {"field t.b real", "exists 7"},
      {"field t.b int \"an int\"", "exists 7"},
      {"field t.shared real", "exists 7"},
  };
  for (const Refused& each : refused) {
    World world;
    ASSERT_EQ(world.read("type t\ntype u_of_t extends t\nfield t.b int\nfield u_of_t.shared int\n"), "");
    const std::uint64_t before = world.database.schema().hash();
    if (each.line == "field t.b int \"an int\"") {
      EXPECT_EQ(world.say(each.line), "") << "a new doc alone is the same declaration";
      continue;
    }
    const std::string told = world.say(each.line);
    EXPECT_EQ(told.substr(0, each.told.size() + 1), each.told + " ") << each.line << " -> " << told;
    EXPECT_LT(told.size(), 500u);
    EXPECT_EQ(world.database.schema().hash(), before) << each.line;
    EXPECT_EQ(world.say("field t.good real"), "") << "a good line works at once";
  }
}

TEST(Declaration, MayBeRepeated) {
  World world;
  const std::string script =
      "type a extends node \"x\"\nfield a.f real cm = 5 in 0 10 \"doc\"\nfield a.g word of x y\n";
  ASSERT_EQ(world.read(script), "");
  const std::uint64_t before = world.database.schema().hash();
  EXPECT_EQ(world.read(script), "");
  EXPECT_EQ(world.say("field a.f real m = 0.05 in 0 0.1"), "") << "the same in another unit";
  EXPECT_EQ(world.database.schema().hash(), before);
  EXPECT_EQ(world.say("field a.f real m = 0.06 in 0 0.1").substr(0, 6), "exists");
}

TEST(Declaration, ReachesSubtypesAndObjectsThatExist) {
  World world;
  ASSERT_EQ(
      world.read("type a\ntype b extends a\nfield b.own int = 1\ncreate a x\ncreate b y\nfield a.f vec3 = 1 2 3\n"),
      "");
  EXPECT_EQ(world.get("x.f"), "1 2 3");
  EXPECT_EQ(world.get("y.f"), "1 2 3");
  EXPECT_EQ(world.get("y.own"), "1");
  EXPECT_EQ(world.say("set y.f 4 5 6"), "");
  EXPECT_EQ(world.get("x.f"), "1 2 3");
}

TEST(SchemaHash, DependsOnEveryPartOfADeclaration) {
  const std::string_view scripts[] = {
      "type t",
      "type u",
      "type t extends node",
      "type t\nfield t.f real",
      "type t\nfield t.g real",
      "type t\nfield t.f real m",
      "type t\nfield t.f real = 1",
      "type t\nfield t.f real in 0 1",
      "type t\nfield t.f real private",
      "type t\nfield t.f real measured",
      "type t\nfield t.f real[]",
      "type t\nfield t.f real[2]",
      "type t\nfield t.f int",
      "type t\nfield t.f word of a b",
      "type t\nfield t.f word of b a",
      "type t\nfield t.f ref",
      "type t\nfield t.f ref:node",
      "type t\nfield t.f ref:t",
  };
  std::vector<std::uint64_t> hashes;
  for (const std::string_view script : scripts) {
    World world;
    ASSERT_EQ(world.read(script), "");
    hashes.push_back(world.database.schema().hash());
  }
  for (std::size_t i = 0; i < hashes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(hashes[i], hashes[j]) << scripts[i] << " / " << scripts[j];
}

}  // namespace
}  // namespace objdb
