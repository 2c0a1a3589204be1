#include "objdb/field.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "tests/objdb/world.h"

namespace objdb {
namespace {

constexpr std::string_view schema = R"(type t
field t.boolean bool
field t.integer int
field t.percent int in 0 100
field t.real real m
field t.positive real s in 0 10
field t.vec3 vec3 m
field t.color vec3 in 0 1
field t.quat quat
field t.word word of left right middle
field t.text text
field t.ref ref
field t.other ref:t
field t.booleans bool[]
field t.integers int[3]
field t.reals real[]
field t.vec3s vec3[2]
field t.eleven real[11] in 0 1
field t.quats quat[]
field t.words word[] of a b -x
field t.texts text[]
field t.refs ref:t[]
field t.many real[70]
create t a
create t b
create node n
)";

struct Taken {
  std::string_view field, words, printed;
};

TEST(Value, IsReadAndPrinted) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  const Taken taken[] = {
      {"boolean", "true", "true"},
      {"boolean", "off", "false"},
      {"boolean", "1", "true"},
      {"boolean", "no", "false"},
      {"boolean", "yes", "true"},
      {"integer", "-9223372036854775808", "-9223372036854775808"},
      {"integer", "+5", "5"},
      {"percent", "0", "0"},
      {"percent", "100", "100"},
      {"real", "4cm", "0.04"},
      {"real", "-0", "-0"},
      {"real", "1e308", "1e+308"},
      {"real", "5e-324", "5e-324"},
      {"positive", "0", "0"},
      {"positive", "-0", "-0"},
      {"positive", "10", "10"},
      {"positive", "10000ms", "10"},
      {"vec3", "1cm 2 3km", "0.01 2 3000"},
      {"color", "0 1 0.5", "0 1 0.5"},
      {"quat", "0 0 0 2", "0 0 0 2"},
      {"quat", "5e-324 0 0 0", "5e-324 0 0 0"},
      {"word", "right", "right"},
      {"word", "\"middle\"", "middle"},
      {"text", "\"two \\\"words\\\"\"", "\"two \\\"words\\\"\""},
      {"text", "-", "\"-\""},
      {"text", "\"\"", "\"\""},
      {"text", "\"a\\nb\"", "\"a\\nb\""},
      {"ref", "n", "n"},
      {"ref", "-", "-"},
      {"other", "a", "a"},
      {"other", "\"\"", "-"},
      {"booleans", "true false", "true false"},
      {"booleans", "-", "-"},
      {"integers", "1 2 3", "1 2 3"},
      {"reals", "1cm 2 3", "ERR"},
      {"reals", "1 2 3", "1 2 3"},
      {"reals", "-", "-"},
      {"vec3s", "1 2 3 4 5 6", "1 2 3 4 5 6"},
      {"quats", "1 0 0 0 0 0 1 0", "1 0 0 0 0 0 1 0"},
      {"words", "a b a", "a b a"},
      {"words", "\"-x\" b", "-x b"},
      {"texts", "a \"b c\" \"\" \"-\"", "a \"b c\" \"\" \"-\""},
      {"texts", "\"-\"", "\"-\""},
      {"refs", "a b a", "a b a"},
      {"refs", "\"\"", "\"\""},
      {"refs", "a - b", "a \"\" b"},
      {"refs", "-", "-"},
  };
  for (const Taken& each : taken) {
    const std::string told = world.say("set a." + std::string(each.field) + " " + std::string(each.words));
    if (each.printed == "ERR") {
      EXPECT_EQ(told.substr(0, 4), "unit");
      continue;
    }
    ASSERT_EQ(told, "") << each.field << " " << each.words;
    EXPECT_EQ(world.get("a." + std::string(each.field)), each.printed);
    // what is printed is read back to the same bits
    const Value before = world.database.find("a")->value(world.database.find("a")->type->find(each.field));
    ASSERT_EQ(world.say("set b." + std::string(each.field) + " " + std::string(each.printed)), "") << each.field;
    EXPECT_TRUE(same_bits(world.database.find("b")->value(world.database.find("b")->type->find(each.field)), before));
  }
}

struct Refused {
  std::string words, told;  // after "set a.", and "KIND COLUMN"
};

TEST(Value, IsRefusedWithKindAndColumnAndNothingChanges) {
  const std::string digits(400, '9');
  const Refused refused[] = {
      {"boolean maybe", "type 15"},
      {"boolean", "syntax 5"},
      {"boolean true false", "syntax 20"},
      {"integer 1.5", "type 15"},
      {"integer \"1\"", "type 15"},
      {"integer 9223372036854775808", "range 15"},
      {"percent 101", "range 15"},
      {"percent -1", "range 15"},
      {"real nan", "type 12"},
      {"real inf", "type 12"},
      {"real -inf", "type 12"},
      {"real 0x1p3", "type 12"},
      {"real 1,5", "type 12"},
      {"real 1e309", "range 12"},
      {"real " + digits, "range 12"},
      {"real 3kg", "unit 12"},
      {"real 3parsec", "unit 12"},
      {"real \"4cm\"", "type 12"},
      {"real 1 2", "syntax 14"},
      {"positive 10.000000000000002", "range 16"},
      {"positive -5e-324", "range 16"},
      {"positive 11000ms", "range 16"},
      {"vec3 1 2", "syntax 14"},
      {"vec3 1 2 3 4", "syntax 18"},
      {"vec3 1 2 x", "type 16"},
      {"color 0 0 1.5", "range 17"},
      {"quat 0 0 0 0", "range 12"},
      {"quat 0 0 0 -0", "range 12"},
      {"word up", "type 12"},
      {"text a b", "syntax 14"},
      {"ref nobody", "unknown 11"},
      {"ref a.b", "syntax 11"},
      {"other n", "type 13"},
      {"integers 1 2", "syntax 18"},
      {"integers 1 2 3 4", "syntax 22"},
      {"vec3s 1 2 3", "syntax 17"},
      {"quats 1 0 0 0 0 0 0 0", "range 21"},
      {"quats 1 0 0", "syntax 17"},
      {"words a c", "type 15"},
      {"refs a n", "type 14"},
      {"refs a nobody", "unknown 14"},
      // wrong in the last of eleven: none is applied
      {"eleven 1 1 1 1 1 1 1 1 1 1 x", "type 34"},
      {"eleven 1 1 1 1 1 1 1 1 1 1 2", "range 34"},
      {"eleven 1 1 1 1 1 1 1 1 1 1 1m", "unit 34"},
      {"eleven[0..1] 1 2", "range 22"},
      {"eleven[10..11] 1 1", "range 7"},
      {"eleven[11] 1", "range 7"},
      {"eleven[0..1] 1", "syntax 5"},
      {"eleven[-1] 1", "syntax 13"},
      {"eleven[1..0] 1", "syntax 13"},
      {"eleven[] 1", "syntax 13"},
      {"eleven[x] 1", "syntax 13"},
      {"eleven[1]x 1", "syntax 13"},
      {"reals[1] 1", "range 7"},
      {"reals[0..4294967294] 1 2 3", "syntax 5"},
      {"reals[0..4294967298] 1 2 3", "syntax 5"},
      {"reals[0..9223372036854775807] 1", "syntax 5"},
      {"reals[0..9223372036854775808] 1", "syntax 12"},
      {"real[0] 1", "type 7"},
      {"nothing 1", "unknown 7"},
      {"rael 1", "unknown 7"},
      {"text* 1", "syntax 7"},
      {" 1", "syntax 7"},
  };
  World world;
  ASSERT_EQ(world.read(schema), "");
  const std::string before = world.everything();
  const std::uint64_t hash = world.database.hash();
  for (const Refused& each : refused) {
    const std::string told = world.say("set a." + each.words);
    EXPECT_EQ(told.substr(0, each.told.size() + 1), each.told + " ") << each.words.substr(0, 100) << " -> " << told;
    EXPECT_LT(told.size(), 400u);
    EXPECT_EQ(world.everything(), before) << each.words;
    EXPECT_EQ(world.database.hash(), hash);
  }
}

TEST(Value, OfElementsIsSetAlone) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  ASSERT_EQ(world.read("set a.integers 1 2 3\nset a.integers[1] 7\n"), "");
  EXPECT_EQ(world.get("a.integers"), "1 7 3");
  ASSERT_EQ(world.read("set a.vec3s[1] 4 5 6\n"), "");
  EXPECT_EQ(world.get("a.vec3s"), "0 0 0 4 5 6");
  // an open array grows by its end
  ASSERT_EQ(world.read("set a.reals[0] 1\nset a.reals[1..2] 2 3\nset a.reals[2..3] 9 10\n"), "");
  EXPECT_EQ(world.get("a.reals"), "1 2 9 10");
  ASSERT_EQ(world.read("set a.texts[0] \"x y\"\nset a.refs[0..1] a -\nset a.words[0] \"-x\"\nset a.quats[0] 0 1 0 0\n"),
            "");
  EXPECT_EQ(world.get("a.texts"), "\"x y\"");
  EXPECT_EQ(world.get("a.refs"), "a \"\"");
  EXPECT_EQ(world.get("a.words"), "-x");
  EXPECT_EQ(world.get("a.quats"), "0 1 0 0");
}

// values that come from a program, not from a line
TEST(Value, FromAProgramIsChecked) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  const Object& a = *world.database.find("a");
  const auto told = [&](std::string_view field, Value value) {
    const Status status = world.database.set(a, a.type->find(field), std::move(value));
    return status ? std::string("ok") : std::string(name_of(status.error().kind));
  };
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(told("real", nan), "type");
  EXPECT_EQ(told("real", infinity), "type");
  EXPECT_EQ(told("real", std::int64_t{1}), "type");
  EXPECT_EQ(told("positive", -1.0), "range");
  EXPECT_EQ(told("vec3", Vec3{0, 0, nan}), "type");
  EXPECT_EQ(told("quat", Quat{0, 0, 0, 0}), "range");
  EXPECT_EQ(told("quats", std::vector<double>{1, 0, 0, 0, 0, 0, 0, 0}), "range");
  EXPECT_EQ(told("reals", std::vector<double>{1, infinity}), "type");
  EXPECT_EQ(told("integers", std::vector<std::int64_t>{1, 2}), "type");
  EXPECT_EQ(told("word", std::int64_t{3}), "range");
  EXPECT_EQ(told("word", std::int64_t{-1}), "range");
  EXPECT_EQ(told("words", std::vector<std::int64_t>{0, 3}), "range");
  EXPECT_EQ(told("boolean", std::int64_t{2}), "range");
  EXPECT_EQ(told("text", std::string("a\rb")), "syntax");
  EXPECT_EQ(told("text", std::string("\xff")), "syntax");
  EXPECT_EQ(told("texts", std::vector<std::string>{"a", "\x01"}), "syntax");
  EXPECT_EQ(told("ref", std::int64_t{99}), "unknown");
  EXPECT_EQ(told("ref", (std::int64_t{1} << 32) + 1), "range");
  EXPECT_EQ(told("ref", std::int64_t{-1}), "range");
  EXPECT_EQ(told("other", static_cast<std::int64_t>(world.database.find("n")->id)), "type");
  EXPECT_EQ(told("real", 2.5), "ok");
  EXPECT_EQ(told("word", std::int64_t{2}), "ok");
  EXPECT_EQ(told("texts", std::vector<std::string>{"a", "\n\t"}), "ok");
  EXPECT_EQ(told("other", static_cast<std::int64_t>(a.id)), "ok");
}

// random values of every field, printed and read back, a hundred thousand of them
TEST(Value, PrintsToWordsThatReadBackToTheSameBits) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  const Object &a = *world.database.find("a"), &b = *world.database.find("b");
  std::mt19937_64 random(1);
  const auto real = [&](const Field& field) {
    if (field.ranged) return field.low + (field.high - field.low) * static_cast<double>(random() % 1025) / 1024;
    while (true)
      if (const auto value = std::bit_cast<double>(random()); std::isfinite(value)) return value;
  };
  const auto discrete = [&](const Field& field) -> std::int64_t {
    switch (field.kind) {
      case Kind::boolean: return static_cast<std::int64_t>(random() % 2);
      case Kind::word: return static_cast<std::int64_t>(random() % field.words.size());
      case Kind::ref: return static_cast<std::int64_t>(random() % 3);
      default: return field.ranged ? static_cast<std::int64_t>(random() % 101) : static_cast<std::int64_t>(random());
    }
  };
  const auto text = [&] {
    std::string out;
    for (std::size_t n = random() % 5; n > 0; --n) out += "a -\"\\\n\t#@"[random() % 9];
    return out;
  };
  LineWords words;
  for (int round = 0; round < 5000; ++round)
    for (int i = 0; i < static_cast<int>(a.slots.size()); ++i) {
      const Field& field = a.type->field(i);
      const std::size_t elements =
          field.count == Field::any_length ? random() % 5 : static_cast<std::size_t>(field.count);
      Value value = zero_value(field);
      if (double* one = std::get_if<double>(&value)) *one = real(field);
      if (auto* vec = std::get_if<Vec3>(&value)) *vec = {real(field), real(field), real(field)};
      if (auto* quat = std::get_if<Quat>(&value)) *quat = {real(field), real(field), real(field), 1};
      if (auto* one = std::get_if<std::string>(&value)) *one = text();
      if (auto* one = std::get_if<std::int64_t>(&value)) *one = discrete(field);
      if (auto* row = std::get_if<Numbers>(&value)) {
        std::vector<double> many(elements * static_cast<std::size_t>(words_of(field.kind)));
        for (double& each : many) each = real(field);
        if (field.kind == Kind::quat)
          for (std::size_t k = 0; k < many.size(); k += 4) many[k] = 1;
        *row = Numbers(std::move(many));
      }
      if (auto* many = std::get_if<std::vector<std::string>>(&value)) {
        many->assign(elements, "");
        for (std::string& each : *many) each = text();
      }
      if (auto* many = std::get_if<std::vector<std::int64_t>>(&value)) {
        many->assign(elements, 0);
        for (std::int64_t& each : *many) each = discrete(field);
      }
      ASSERT_TRUE(world.database.set(a, i, value).ok()) << field.name;
      std::string line;
      append_set(line, world.database, a, i);
      line[4] = 'b';
      line.pop_back();
      ASSERT_EQ(world.say(line), "") << line;
      ASSERT_TRUE(same_bits(b.value(i), value)) << line;
    }
}

TEST(Value, OfAnyLengthIsSaidInLinesThatFit) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  const Object& a = *world.database.find("a");
  std::vector<double> numbers(20'000, 0.1 + 0.2);
  std::vector<std::string> texts = {std::string(40'000, 'x'), std::string(60'000, 'y'), std::string(10, 'z')};
  ASSERT_TRUE(world.database.set(a, a.type->find("reals"), numbers).ok());
  ASSERT_TRUE(world.database.set(a, a.type->find("texts"), texts).ok());
  ASSERT_TRUE(world.database.set(a, a.type->find("text"), std::string(50'000, 'w')).ok());
  std::string out;
  append_set(out, world.database, a, a.type->find("reals"));
  append_set(out, world.database, a, a.type->find("texts"));
  append_set(out, world.database, a, a.type->find("text"));
  // over an older, longer value, so that nothing of it may stay
  World other;
  ASSERT_EQ(other.read(schema), "");
  const Object& there = *other.database.find("a");
  ASSERT_TRUE(other.database.set(there, there.type->find("reals"), std::vector<double>(50'000, 7)).ok());
  ASSERT_EQ(other.read(out), "");
  for (const char* field : {"reals", "texts", "text"})
    EXPECT_TRUE(same_bits(there.value(there.type->find(field)), a.value(a.type->find(field)))) << field;
}

TEST(Text, ThatFitsNoLineIsRefused) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  // "set a.text " and the newline take 12 bytes
  const std::string longest(longest_line - 12, 'x');
  EXPECT_EQ(world.say("set a.text " + longest), "");
  EXPECT_EQ(world.get("a.text").size(), longest.size());
  const std::string saved = save(world.database);
  World other;
  EXPECT_EQ(other.read(saved), "");
  EXPECT_EQ(other.database.hash(), world.database.hash());
  // a bare word of backslashes needs quotes, and twice the room, when it is said again
  EXPECT_EQ(world.say("set a.text x" + std::string(40'000, '\\')).substr(0, 8), "limit 12");
  EXPECT_EQ(world.say("set **.text " + std::string(40'000, '\\')).substr(0, 5), "limit");
  EXPECT_EQ(world.say("create t c text " + std::string(40'000, '\\')).substr(0, 5), "limit");
  EXPECT_EQ(world.database.find("c"), nullptr);
  EXPECT_EQ(world.get("a.text").size(), longest.size());
}

// short decimals are read without a library call: bit for bit what the library reads
TEST(Value, OfAShortDecimalIsTheNearestDouble) {
  World world;
  ASSERT_EQ(world.read(schema), "");
  std::mt19937_64 random(3);
  LineWords words;
  Value value;
  const Field& field = world.database.schema().find("t")->field(world.database.schema().find("t")->find("real"));
  for (int i = 0; i < 200'000; ++i) {
    std::string text = random() % 2 == 0 ? "-" : "";
    const std::uint64_t digits = 1 + random() % 17, point = random() % 20;
    for (std::uint64_t k = 0; k < digits; ++k) {
      if (k == point && k > 0) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    ASSERT_TRUE(words.split(text).ok());
    ASSERT_TRUE(parse_value_into(field, words.words(), world.database, value).ok()) << text;
    const double expected = std::strtod(text.c_str(), nullptr);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(std::get<double>(value)), std::bit_cast<std::uint64_t>(expected)) << text;
  }
}

}  // namespace
}  // namespace objdb
