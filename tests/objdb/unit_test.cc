#include "objdb/unit.h"

#include <bit>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include "objdb/text.h"

namespace objdb {
namespace {

Dimension dimension(std::string_view unit) {
  const std::optional<Unit> parsed = parse_unit(unit);
  EXPECT_TRUE(parsed.has_value()) << unit;
  return parsed ? parsed->dimension : Dimension{};
}

struct Reading {
  std::string_view text, unit;
  double value;
};

// what a person writes by hand in SI must be the same double as what they write in a handier unit
TEST(Real, IsReadInItsUnit) {
  constexpr double pi = std::numbers::pi;
  const Reading readings[] = {{"4cm", "m", 0.04},
                              {"7cm", "m", 0.07},
                              {"0.7mm", "m", 0.0007},
                              {"30deg", "rad", pi / 6},
                              {"180deg", "rad", pi},
                              {"1rev", "rad", 2 * pi},
                              {"1.5m/s", "m/s", 1.5},
                              {"36km/h", "m/s", 10},
                              {"200ms", "s", 0.2},
                              {"0.4N", "N", 0.4},
                              {"15kPa", "Pa", 15000},
                              {"1kg*m/s^2", "N", 1},
                              {"9.81m/s2", "m/s2", 9.81},
                              {"60Hz", "Hz", 60},
                              {"5s^-1", "Hz", 5},
                              {"50%", "", 0.5},
                              {"1e3", "m", 1000},
                              {"-.5", "m", -0.5},
                              {"+2", "m", 2},
                              {"-0", "m", -0.0},
                              {"1e308", "m", 1e308},
                              {"5e-324", "m", 5e-324},
                              {"1e-400", "m", 0},
                              {"-1e-400", "m", -0.0},
                              {"2h", "s", 7200},
                              {"3t", "kg", 3000},
                              {"10arcmin", "rad", 10 * pi / 10800},
                              {"1W/m^2", "W/m^2", 1},
                              {"1mJ", "N*m", 0.001},
                              {"90deg/s", "rad/s", pi / 2}};
  for (const Reading& reading : readings) {
    const Result<double> value = parse_real(reading.text, dimension(reading.unit));
    ASSERT_TRUE(value.ok()) << reading.text << ": " << value.error().sentence;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*value), std::bit_cast<std::uint64_t>(reading.value)) << reading.text;
  }
}

TEST(Real, RefusesWhatIsNoNumber) {
  for (const char* text :
       {"",  "nan", "inf",   "-inf", "infinity", "NaN", "0x1p3", "0x10", "1,5",  "abc",  "+-5",   "--5",  "+",
        "-", ".",   "1_000", "1 5",  "5/s",      "e5",  "3e",    "3e+",  "-nan", "+inf", "1.2.3", "5..6", "1e5.5"})
    for (const char* unit : {"", "m"}) {
      const Result<double> value = parse_real(text, dimension(unit));
      ASSERT_FALSE(value.ok()) << text;
      EXPECT_EQ(value.error().kind, ErrorKind::type) << text << ": " << value.error().sentence;
    }
}

TEST(Real, RefusesAUnitThatDoesNotFit) {
  for (const char* text :
       {"3kg", "3rad", "3m^2", "3m*s", "3Hz", "3parsec", "3m//s", "3m^", "3m^0", "3m^10", "3%", "3m/", "3cmm"}) {
    const Result<double> value = parse_real(text, dimension("m"));
    ASSERT_FALSE(value.ok()) << text;
    EXPECT_EQ(value.error().kind, ErrorKind::unit) << text << ": " << value.error().sentence;
  }
  EXPECT_EQ(parse_real("3m", {}).error().kind, ErrorKind::unit);
}

TEST(Real, RefusesWhatIsBeyondADouble) {
  std::string digits(400, '9');
  for (const std::string& text :
       {std::string("1e309"), std::string("-1e309"), digits, std::string("1e306km"), std::string("1e999999999999")}) {
    const Result<double> value = parse_real(text, dimension("m"));
    ASSERT_FALSE(value.ok()) << text;
    EXPECT_EQ(value.error().kind, ErrorKind::range) << text;
  }
  EXPECT_TRUE(parse_real("0." + digits, dimension("m")).ok());
  EXPECT_EQ(*parse_real("1" + std::string(300, '0'), {}), 1e300);
  EXPECT_EQ(*parse_real("179769313486231570" + std::string(291, '0'), {}), 1.7976931348623157e308);
}

// a unit made of large factors that cancel in dimension but not in size
TEST(Real, NeverBecomesInfiniteOrNotANumber) {
  std::string unit = "m";
  for (int i = 0; i < 12; ++i) {
    unit += "*GPa^9/Pa^9";
    const Result<double> value = parse_real("1" + unit, dimension("m"));
    if (value.ok()) {
      EXPECT_TRUE(std::isfinite(*value)) << unit;
    }
  }
  EXPECT_FALSE(parse_real("1" + unit, dimension("m")).ok());
  EXPECT_FALSE(parse_real("0" + unit, dimension("m")).ok());
}

// a locale that has a decimal comma and nothing else, made on the spot
class DecimalComma : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("comma_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "source")
        << "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \"\"\ngrouping -1\nEND LC_NUMERIC\n";
    const std::string folder = folder_.string();
    const std::string command =
        "localedef -c -f ANSI_X3.4-1968 -i " + folder + "/source " + folder + "/comma >/dev/null 2>&1";
    [[maybe_unused]] const int status = std::system(command.c_str());
    setenv("LOCPATH", folder.c_str(), 1);
    if (setlocale(LC_NUMERIC, "comma") == nullptr) GTEST_SKIP() << "localedef cannot make a locale here";
  }
  void TearDown() override {
    setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
    std::filesystem::remove_all(folder_);
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(DecimalComma, ChangesNoNumber) {
  char printed[16];
  std::snprintf(printed, sizeof printed, "%.1f", 1.5);
  ASSERT_STREQ(printed, "1,5") << "the locale is in force";
  EXPECT_EQ(*parse_real("1.5", {}), 1.5);
  EXPECT_EQ(*parse_real("1.5cm", dimension("m")), 0.015);
  // beyond the range of from_chars: the slow path
  EXPECT_EQ(*parse_real("1.5e-400", {}), 0);
  EXPECT_EQ(parse_real("1.5e400", {}).error().kind, ErrorKind::range);
  EXPECT_EQ(parse_real("1,5", {}).error().kind, ErrorKind::type);
  EXPECT_EQ(number(1234.5), "1234.5");
}

TEST(Unit, NameOfADimensionReadsBack) {
  const std::string_view units[] = {
      "m",    "kg",   "s",         "A",    "K",    "cd",     "rad", "Hz",     "N",       "Pa",      "J",        "W",
      "V",    "m/s",  "m/s^2",     "m^2",  "m^3",  "kg/m^3", "N*m", "N/m",    "N*s/m",   "rad/s",   "W/m^2",    "s^2",
      "Pa*s", "m^-1", "m^-2*s^-3", "kg^9", "m^-9", "1",      "V/m", "cd/m^2", "rad/s^2", "N*m/rad", "N*m*s/rad"};
  for (const std::string_view text : units) {
    const std::optional<Unit> unit = parse_unit(text);
    if (text == "1") {
      EXPECT_FALSE(unit.has_value());
      continue;
    }
    ASSERT_TRUE(unit.has_value()) << text;
    const std::optional<Unit> again = parse_unit(si_name(unit->dimension));
    ASSERT_TRUE(again.has_value()) << text << " is called " << si_name(unit->dimension);
    EXPECT_EQ(again->dimension, unit->dimension) << text;
    EXPECT_TRUE(again->is_si()) << text;
  }
  // every exponent of every base unit, alone and in pairs
  for (std::size_t i = 0; i < 7; ++i)
    for (std::size_t j = 0; j < 7; ++j)
      for (std::int8_t a = -9; a <= 9; ++a)
        for (std::int8_t b = -9; b <= 9; ++b) {
          Dimension d;
          d.exponents[i] = a;
          d.exponents[j] = b;
          const std::optional<Unit> unit = parse_unit(si_name(d));
          ASSERT_TRUE(unit.has_value()) << si_name(d);
          ASSERT_EQ(unit->dimension, d) << si_name(d);
        }
}

TEST(Integer, IsWholeAndFits) {
  EXPECT_EQ(*parse_integer("42"), 42);
  EXPECT_EQ(*parse_integer("+42"), 42);
  EXPECT_EQ(*parse_integer("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(*parse_integer("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(parse_integer("9223372036854775808").error().kind, ErrorKind::range);
  EXPECT_EQ(parse_integer(std::string(400, '1')).error().kind, ErrorKind::range);
  for (const char* text : {"", "1.0", "1e3", "0x10", "+-5", "--5", "-", "+", " 1", "1 ", "one"})
    EXPECT_EQ(parse_integer(text).error().kind, ErrorKind::type) << text;
  for (const char* text : {"5m", "5%", "-5kg"}) EXPECT_EQ(parse_integer(text).error().kind, ErrorKind::unit) << text;
}

TEST(Prefix, StandsBeforeEveryUnitThatTakesOne) {
  EXPECT_EQ(*parse_real("500nm", parse_unit("m")->dimension), 500 / 1e9);
  EXPECT_EQ(*parse_real("3dm", parse_unit("m")->dimension), 0.3);
  EXPECT_EQ(*parse_real("2MHz", parse_unit("Hz")->dimension), 2e6);
  EXPECT_EQ(*parse_real("5uN", parse_unit("N")->dimension), 5e-6);
  EXPECT_EQ(*parse_real("7mNm", parse_unit("N*m")->dimension), 0.007);
  EXPECT_EQ(*parse_real("7mg", parse_unit("kg")->dimension), 7e-6);
  // the minute is no thousandth of an inch, the candela no hundredth of a day
  EXPECT_EQ(*parse_real("2min", parse_unit("s")->dimension), 120);
  EXPECT_TRUE(parse_unit("cd").has_value());
  for (const char* text : {"mkg", "kmm", "mdeg", "kmin", "xm", "k", "%m", "mt"}) EXPECT_FALSE(parse_unit(text)) << text;
}

}  // namespace
}  // namespace objdb
