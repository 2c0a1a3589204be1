// Two manipulators for tests and measurements of long arrays.
//   sheets fill [FILE]   moves the points of every `sheet`; all numbers of a tick are told from those of another. At
//   its
//                        end it writes the seconds between its ticks to FILE, as doubles
//   sheets read          looks at every number of every tick, and counts the frames that hold numbers of two ticks
#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "manipulators/kit/manipulator.h"

namespace {

using objdb::Object;

constexpr char filling[] = R"(
  type sheet extends node "points that move"
  field sheet.count int = 1000 in 0 1000000 "points"
  field sheet.points vec3[] m
  field sheet.times int = 1 in 0 100 "how often they are written in a tick"
  field sheet.memory real private
  writes sheet.points
)";
constexpr char reading[] = R"(
  type reader "of sheets"
  field reader.frames int
  field reader.torn int
  field reader.sum real m
  field reader.seen int private
  reads sheet.points
  writes reader.frames reader.torn reader.sum
)";

// a number is 4 tick + (place modulo 1024) / 1024, exact in a double, so that the tick can be told from every number
constexpr std::size_t period = 1024;
const std::array<double, period> fraction = [] {
  std::array<double, period> out;
  for (std::size_t i = 0; i < period; ++i) out[i] = static_cast<double>(i) / period;
  return out;
}();

void write(std::span<double> points, double first) {
  for (std::size_t at = 0; at < points.size(); at += period) {
    const std::size_t count = std::min(period, points.size() - at);
    for (std::size_t i = 0; i < count; ++i) points[at + i] = first + fraction[i];
  }
}

bool is_whole(std::span<const double> points) {
  const double first = points[0];
  std::uint64_t difference = 0;
  for (std::size_t at = 0; at < points.size(); at += period) {
    const std::size_t count = std::min(period, points.size() - at);
    for (std::size_t i = 0; i < count; ++i)
      difference |= std::bit_cast<std::uint64_t>(points[at + i]) ^ std::bit_cast<std::uint64_t>(first + fraction[i]);
  }
  return difference == 0;
}

int fill(const char* file) {
  kit::Manipulator me("sheets", filling);
  me.on_checkpoint([] {});
  std::vector<double> times;
  std::chrono::steady_clock::time_point last{};
  me.on_tick([&](const kit::Tick& tick) {
    const auto now = std::chrono::steady_clock::now();
    if (file != nullptr) times.push_back(std::chrono::duration<double>(now - last).count());
    last = now;
    for (const Object* sheet : me.objects("sheet"))
      for (std::int64_t time = me.get<std::int64_t>(*sheet, "times"); time > 0; --time)
        me.fill(*sheet, "points", 3 * static_cast<std::size_t>(me.get<std::int64_t>(*sheet, "count")),
                [&](std::span<double> points) {
                  write(points, static_cast<double>(tick.number * 4) + 1024 * static_cast<double>(time - 1));
                });
  });
  const int status = me.run();
  if (std::FILE* out = file == nullptr ? nullptr : std::fopen(file, "wb")) {
    std::fwrite(times.data(), sizeof(double), times.size(), out);
    std::fclose(out);
  }
  return status;
}

int read() {
  kit::Manipulator me("sheets", reading);
  me.on_checkpoint([] {});
  me.on_tick([&](const kit::Tick&) {
    for (const Object* reader : me.objects("reader")) {
      double sum = me.get<double>(*reader, "sum");
      std::int64_t torn = me.get<std::int64_t>(*reader, "torn");
      for (const Object* sheet : me.objects("sheet")) {
        const std::span<const double> points = me.numbers(*sheet, "points");
        if (points.empty()) continue;
        torn += is_whole(points) ? 0 : 1;
        // order counts, so that a frame told twice or not at all shows
        sum = std::fmod(sum * 3 + points[0], 1e6);
      }
      me.set(*reader, "frames", me.get<std::int64_t>(*reader, "frames") + 1);
      me.set(*reader, "torn", torn);
      me.set(*reader, "sum", sum);
    }
  });
  return me.run();
}

}  // namespace

int main(int count, char** words) {
  if ((count == 2 || count == 3) && std::strcmp(words[1], "fill") == 0) return fill(count == 3 ? words[2] : nullptr);
  if (count == 2 && std::strcmp(words[1], "read") == 0) return read();
  std::fprintf(stderr, "sheets fill [FILE]|read\n");
  return 2;
}
