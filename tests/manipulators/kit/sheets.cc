// Two manipulators for tests and measurements of long arrays.
//   sheets fill   moves the points of every `sheet`; all numbers of a tick are told from those of another
//   sheets read   looks at every number of every tick, and counts the frames that hold numbers of two ticks
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

// exact in a double, so that the tick can be told from every number
double number_of(std::uint64_t tick, std::size_t i) {
  return static_cast<double>(tick * 4) + static_cast<double>(i % 1024) / 1024;
}

int fill() {
  kit::Manipulator me("sheets", filling);
  me.on_checkpoint([] {});
  me.on_tick([&](const kit::Tick& tick) {
    for (const Object* sheet : me.objects("sheet")) {
      std::vector<double> points(3 * static_cast<std::size_t>(me.get<std::int64_t>(*sheet, "count")));
      for (std::size_t i = 0; i < points.size(); ++i) points[i] = number_of(tick.number, i);
      me.set(*sheet, "points", std::move(points));
    }
  });
  return me.run();
}

int read() {
  kit::Manipulator me("sheets", reading);
  me.on_checkpoint([] {});
  me.on_tick([&](const kit::Tick&) {
    for (const Object* reader : me.objects("reader")) {
      double sum = me.get<double>(*reader, "sum");
      std::int64_t torn = me.get<std::int64_t>(*reader, "torn");
      for (const Object* sheet : me.objects("sheet")) {
        const auto& points = me.get<std::vector<double>>(*sheet, "points");
        if (points.empty()) continue;
        const double first = points[0];
        bool whole = true;
        for (std::size_t i = 0; i < points.size(); ++i)
          whole = whole && points[i] == first + static_cast<double>(i % 1024) / 1024;
        torn += whole ? 0 : 1;
        // order counts, so that a frame told twice or not at all shows
        sum = std::fmod(sum * 3 + first, 1e6);
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
  if (count == 2 && std::strcmp(words[1], "fill") == 0) return fill();
  if (count == 2 && std::strcmp(words[1], "read") == 0) return read();
  std::fprintf(stderr, "sheets fill|read\n");
  return 2;
}
