#include "manipulators/face_fem/range_scan.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "manipulators/mesh/tree.h"

namespace face {
namespace {

/// Words of a text with their lines.
class Words {
 public:
  Words(const std::string& text, std::string name) : text_(text), name_(std::move(name)) {}

  std::string next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::string line() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    const std::string found = text_.substr(begin, at_ - begin);
    if (at_ < text_.size()) ++at_, ++line_;
    return found;
  }
  bool done() const { return at_ >= text_.size(); }

  template <class Number>
  Result<Number> number(const char* of) {
    const std::string word = next();
    if (word.empty()) return Error{Fault::truncated, name_ + ": ends where " + of + " is expected"};
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      return fault(Fault::syntax, std::string(of) + " must be a number, is '" + word.substr(0, 40) + "'");
    return value;
  }
  Error fault(Fault kind, const std::string& sentence) const {
    return {kind, name_ + ":" + std::to_string(line_) + ": " + sentence};
  }

 private:
  const std::string& text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

constexpr int most = 4'000'000;  // points or polygons: above it the count itself is taken for a mistake

Status read_points(Words& words, std::vector<Eigen::Vector3f>& points) {
  const auto count = words.number<int>("the count of points");
  if (!count) return count.error();
  if (*count < 3 || *count > most)
    return words.fault(Fault::syntax, "a scan has 3 to 4000000 points, says " + std::to_string(*count));
  words.next();  // float or double
  for (int k = 0; k < *count; ++k) {
    Eigen::Vector3f p;
    for (int i = 0; i < 3; ++i) {
      const auto x = words.number<float>("a coordinate");
      if (!x) return x.error();
      p[i] = *x;
    }
    if (!p.allFinite()) return words.fault(Fault::not_finite, "a coordinate must be finite");
    points.push_back(p);
  }
  return success();
}

Status read_polygons(Words& words, std::vector<Eigen::Vector3i>& faces) {
  const auto count = words.number<int>("the count of polygons");
  if (!count) return count.error();
  words.next();  // length of the list
  for (int k = 0; k < *count; ++k) {
    const auto corners = words.number<int>("a count of corners");
    if (!corners) return corners.error();
    if (*corners != 3 && *corners != 4)
      return words.fault(Fault::syntax, "polygons must have 3 or 4 corners, one has " + std::to_string(*corners));
    int c[4];
    for (int i = 0; i < *corners; ++i) {
      const auto corner = words.number<int>("a corner");
      if (!corner) return corner.error();
      c[i] = *corner;
    }
    faces.push_back({c[0], c[1], c[2]});
    if (*corners == 4) faces.push_back({c[0], c[2], c[3]});
  }
  return success();
}

/// Mean difference in depth between both sides of the plane x = middle after a turn by `angle` about y, metres.
double asymmetry(const mesh::Surface& scan, float angle, float middle) {
  mesh::Surface turned = scan;
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(-angle, Eigen::Vector3f::UnitY()).toRotationMatrix();
  turned.V = (scan.V * turn.transpose()).eval();
  const mesh::Tree tree(turned.V, turned.F);
  const mesh::Bounds box = mesh::bounds(turned);
  const auto depth = [&](double x, double y) {
    const mesh::Tree::Hit hit = tree.first_hit({x, y, box.upper.z() + 0.01}, {x, y, box.lower.z() - 0.01});
    return hit.face < 0 ? NAN : hit.share * (box.upper.z() - box.lower.z() + 0.02);
  };
  double sum = 0;
  int count = 0;
  for (int j = 2; j <= 8; ++j)
    for (int i = 1; i <= 8; ++i) {
      const double y = box.lower.y() + 0.1 * j * (box.upper.y() - box.lower.y()), x = 0.006 * i;
      const double miss = std::abs(depth(middle + x, y) - depth(middle - x, y));
      if (std::isfinite(miss)) sum += miss, ++count;
    }
  return count < 20 ? HUGE_VAL : sum / count;
}

/// Turns the nose to +Z, the plane of symmetry to x = 0 and the faces outward.
void orient(mesh::Surface& scan) {
  const mesh::Bounds box = mesh::bounds(scan);
  const float height = box.upper.y() - box.lower.y();
  Eigen::Index nose = 0;
  float best = -1;
  for (Eigen::Index v = 0; v < scan.V.rows(); ++v) {
    const float up = (scan.V(v, 1) - box.lower.y()) / height;
    if (up > 0.33F && up < 0.67F && std::hypot(scan.V(v, 0), scan.V(v, 2)) > best) {
      best = std::hypot(scan.V(v, 0), scan.V(v, 2));
      nose = v;
    }
  }
  // the nose is near the middle; from there a search in halved steps
  float angle = std::atan2(scan.V(nose, 0), scan.V(nose, 2)), middle = 0, step = 0.07F, across = 0.006F;
  double least = asymmetry(scan, angle, middle);
  if (std::isfinite(least))
    for (int round = 0; round < 40 && step > 0.002F; ++round) {
      const float from = angle, at = middle;
      for (int a = -1; a <= 1; ++a)
        for (int m = -1; m <= 1; ++m) {
          const double here = asymmetry(scan, from + float(a) * step, at + float(m) * across);
          if (here < least) {
            least = here;
            angle = from + float(a) * step;
            middle = at + float(m) * across;
          }
        }
      if (angle == from && middle == at) step /= 2, across /= 2;
    }
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(-angle, Eigen::Vector3f::UnitY()).toRotationMatrix();
  scan.V = (scan.V * turn.transpose()).eval();
  scan.V.col(0).array() -= middle;
  double outward = 0;
  for (Eigen::Index f = 0; f < scan.F.rows(); ++f) {
    const Eigen::Vector3f a = scan.V.row(scan.F(f, 0)), b = scan.V.row(scan.F(f, 1)), c = scan.V.row(scan.F(f, 2));
    outward += (b - a).cross(c - a).dot(Eigen::Vector3f(a.x(), 0, a.z()));
  }
  if (outward < 0) scan.F.col(1).swap(scan.F.col(2));
}

}  // namespace

Result<mesh::Surface> parse_range_scan(const std::string& text, const std::string& name) {
  Words words(text, name);
  if (words.line().rfind("# vtk DataFile", 0) != 0)
    return Error{Fault::syntax, name + ":1: a range scan starts with '# vtk DataFile'"};
  words.line();  // title
  if (const std::string form = words.next(); form != "ASCII")
    return words.fault(Fault::syntax, "only ASCII scans are read, this is '" + form.substr(0, 40) + "'");
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3i> faces;
  int wide = 0, high = 0;
  while (!words.done()) {
    const std::string word = words.next();
    if (word == "DIMENSIONS") {
      int size[3];
      for (int& n : size) {
        const auto number = words.number<int>("a dimension");
        if (!number) return number.error();
        n = *number;
      }
      wide = size[0];
      high = size[1];
      if (wide < 2 || high < 2 || size[2] != 1 || wide > most / high)
        return words.fault(Fault::syntax, "dimensions must be angles, heights (2 or more) and 1");
    } else if (word == "POINTS") {
      if (auto status = read_points(words, points); !status) return status.error();
    } else if (word == "POLYGONS") {
      if (auto status = read_polygons(words, faces); !status) return status.error();
    } else if (word == "CELL_DATA" || word == "POINT_DATA") {
      break;
    }
  }
  if (points.empty()) return Error{Fault::truncated, name + ": ends before POINTS"};
  if (wide > 0 && std::size_t(wide) * high != points.size())
    return Error{Fault::syntax, name + ": " + std::to_string(wide) + " x " + std::to_string(high) +
                                    " points expected, has " + std::to_string(points.size())};
  for (int j = 0; j + 1 < high; ++j)
    for (int i = 0; i + 1 < wide; ++i) {
      const int a = j * wide + i;
      faces.push_back({a, a + 1, a + wide + 1});
      faces.push_back({a, a + wide + 1, a + wide});
    }
  if (faces.empty()) return Error{Fault::truncated, name + ": has neither POLYGONS nor DIMENSIONS"};

  mesh::Surface scan;
  scan.part_names = {"scan"};
  scan.part.assign(faces.size(), 0);
  scan.V.resize(Eigen::Index(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) scan.V.row(Eigen::Index(k)) = points[k].transpose();
  scan.F.resize(Eigen::Index(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    scan.F.row(Eigen::Index(f)) = faces[f].transpose();
    if (faces[f].minCoeff() < 0 || faces[f].maxCoeff() >= int(points.size()))
      return Error{Fault::unknown, name + ": polygon " + std::to_string(f) + " names a point that is not there"};
  }
  orient(scan);
  return scan;
}

Result<mesh::Surface> read_range_scan(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{Fault::io, path + " cannot be read"};
  std::stringstream text;
  text << file.rdbuf();
  return parse_range_scan(text.str(), path);
}

}  // namespace face
