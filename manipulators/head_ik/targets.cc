#include "manipulators/head_ik/targets.h"

#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "manipulators/head_ik/figure.h"

namespace head {
namespace {

constexpr std::string_view orientation_header = "r11,r12,r13,r21,r22,r23,r31,r32,r33";
constexpr std::string_view point_header = "x,y,z";
constexpr double orthonormal = 1e-4;

struct Place {
  const std::string& file;
  int line = 0;

  FileError error(int column, std::string_view kind, const std::string& sentence) const {
    return {file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": error " + std::string(kind) + " " +
            sentence};
  }
};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  return text;
}

// `count` numbers between commas, or what is wrong with them
std::variant<std::array<double, 9>, FileError> numbers(std::string_view line, int count, const Place& place) {
  std::array<double, 9> values{};
  const char* const begin = line.data();
  for (int i = 0; i < count; ++i) {
    const std::size_t comma = line.find(',');
    const std::string_view cell = trimmed(line.substr(0, comma));
    const int column = static_cast<int>(line.data() - begin) + 1;
    const bool last = i + 1 == count;
    if (last != (comma == std::string_view::npos))
      return place.error(column, "syntax",
                         last ? "more than " + std::to_string(count) + " cells in the row"
                              : std::to_string(i + 1) + " cells in the row, expected " + std::to_string(count));
    const auto [end, bad] = std::from_chars(cell.data(), cell.data() + cell.size(), values[i]);
    if (bad != std::errc() || end != cell.data() + cell.size() || !std::isfinite(values[i]))
      return place.error(column, "type", "expected a finite number, found `" + std::string(cell) + "`");
    if (!last) line.remove_prefix(comma + 1);
  }
  return values;
}

}  // namespace

std::variant<Targets, FileError> read_targets(const std::string& file) {
  std::ifstream stream(file);
  Place place{file};
  if (!stream) return place.error(0, "io", "cannot be read");
  Targets targets;
  std::string text;
  int columns = 0;
  while (std::getline(stream, text)) {
    ++place.line;
    const std::string_view line = trimmed(text);
    if (line.empty()) continue;
    if (columns == 0) {
      columns = line == orientation_header ? 9 : line == point_header ? 3 : 0;
      if (columns == 0)
        return place.error(1, "syntax",
                           "expected the header `" + std::string(orientation_header) + "` or `" +
                               std::string(point_header) + "`, found `" + std::string(line) + "`");
      continue;
    }
    const auto row = numbers(line, columns, place);
    if (const auto* error = std::get_if<FileError>(&row)) return *error;
    const auto& v = std::get<0>(row);
    if (columns == 3) {
      targets.points.emplace_back(v[0], v[1], v[2]);
      continue;
    }
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
    const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(off <= orthonormal))
      return place.error(
          1, "range",
          "the row is no rotation: off orthonormal by " + number(off) + ", expected at most " + number(orthonormal));
    if (R.determinant() < 0)
      return place.error(1, "range", "the row is a reflection: its determinant is -1, expected 1");
    targets.orientations.push_back(R);
  }
  if (stream.bad()) return place.error(0, "io", "cannot be read");
  if (columns == 0) return place.error(0, "syntax", "is empty, expected a header and rows");
  return targets;
}

}  // namespace head
