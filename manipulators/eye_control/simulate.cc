#include "manipulators/eye_control/simulate.h"

#include <cmath>
#include <ostream>

#include "objdb/text.h"

namespace eye {

using objdb::ErrorKind;
using objdb::Status;

namespace {

constexpr double longest = 86400;        // of a course, s
constexpr double most_turns = 36000;     // of azimuth, deg
constexpr double least_distance = 1e-3;  // m

// reads the rows of a course: each cell by the name of its column, errors with its place
class Course {
 public:
  Course(const Table& table, const std::string& name) : table_(table), name_(name) {}

  size_t rows() const { return table_.rows.size(); }
  bool has(std::string_view column) const { return table_.column(column) >= 0; }
  double at(size_t row, std::string_view column) const {
    return table_.rows[row][static_cast<size_t>(table_.column(column))];
  }

  objdb::Error error(size_t row, std::string_view column, ErrorKind kind, const std::string& sentence) const {
    return cell_error(name_, table_.lines[row], table_.places[row][static_cast<size_t>(table_.column(column))], kind,
                      std::string(column) + " " + sentence);
  }

  // the value of a cell that must lie between two bounds
  Status between(size_t row, std::string_view column, double low, double high) const {
    const double value = at(row, column);
    if (value >= low && value <= high) return {};
    if (std::isnan(value)) return error(row, column, ErrorKind::type, "is empty, expected a number");
    return error(
        row, column, ErrorKind::range,
        "must be between " + objdb::number(low) + " and " + objdb::number(high) + ", not " + objdb::number(value));
  }

  // that there are rows, and that time goes on, and not for ever
  Status times() const {
    if (rows() == 0) return cell_error(name_, 1, 1, ErrorKind::syntax, "the table has a header but no rows");
    for (size_t k = 0; k < rows(); ++k) {
      if (Status status = between(k, "t_s", -1e6, 1e6); !status) return status;
      const double time = at(k, "t_s");
      if (k > 0 && time < at(k - 1, "t_s")) {
        return error(k, "t_s", ErrorKind::range,
                     "must not fall, but " + objdb::number(time) + " follows " + objdb::number(at(k - 1, "t_s")));
      }
      if (time - at(0, "t_s") > longest) {
        return error(k, "t_s", ErrorKind::range,
                     "is " + objdb::number(time - at(0, "t_s")) + " s after the first row, expected at most " +
                         objdb::number(longest));
      }
    }
    return {};
  }

  Status angles(size_t row) const {
    if (Status status = between(row, "azimuth_deg", -most_turns, most_turns); !status) return status;
    return between(row, "elevation_deg", -90, 90);
  }

 private:
  const Table& table_;
  const std::string& name_;
};

// angle between two directions, with the sign of the larger component of the change
double signed_angle(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Vec2 change) {
  const double size = std::atan2(from.cross(to).norm(), from.dot(to));
  const double larger = std::abs(change.x) >= std::abs(change.y) ? change.x : change.y;
  return std::copysign(size, larger);
}

}  // namespace

Status fill_target(Track& track, const Table& table, const std::string& name) {
  const Course course(table, name);
  if (Status status = course.times(); !status) return status;
  const bool near = course.has("distance_m");
  for (size_t k = 0; k < course.rows(); ++k) {
    const double time = course.at(k, "t_s");
    const double azimuth = course.at(k, "azimuth_deg"), elevation = course.at(k, "elevation_deg");
    if (std::isnan(azimuth) || std::isnan(elevation)) {
      track.add(time, Eigen::Vector3d::Zero(), false);
      continue;
    }
    if (Status status = course.angles(k); !status) return status;
    double nearness = 0;
    if (near && !std::isnan(course.at(k, "distance_m"))) {
      if (Status status = course.between(k, "distance_m", least_distance, 1e300); !status) return status;
      nearness = 1 / course.at(k, "distance_m");
    }
    track.add(time, {azimuth * deg, elevation * deg, nearness});
  }
  return {};
}

Status fill_head(Track& track, const Table& table, const std::string& name) {
  const Course course(table, name);
  if (Status status = course.times(); !status) return status;
  for (size_t k = 0; k < course.rows(); ++k) {
    if (Status status = course.angles(k); !status) return status;
    track.add(course.at(k, "t_s"), {course.at(k, "azimuth_deg") * deg, course.at(k, "elevation_deg") * deg, 0});
  }
  return {};
}

void simulate(FollowingWorld& world, std::shared_ptr<const Parameters> parameters, Frame frame,
              const std::function<void(const TraceRow&, const Gaze&)>& each) {
  const double step = parameters->step;
  const double eye_distance = parameters->eye_distance, range = parameters->range;
  const bool follows = parameters->head_free >= 0.5;
  const auto first = static_cast<int64_t>(std::llround(world.target_track().first() / step));
  const auto last = static_cast<int64_t>(std::llround(world.target_track().last() / step));

  // before the start the eyes rest on the target's first visible place
  Gaze gaze(std::move(parameters));
  const double start = static_cast<double>(first) * step;
  Aim rest;
  for (const Track::Knot& knot : world.target_track().knots()) {
    Sight sight;
    if (!knot.present) continue;
    const HeadPose head = world.head(start);
    if (world.target(knot.time, Track::Side::right, head, sight)) rest = aim_at(sight, eye_distance, range);
    break;
  }
  gaze.rest(rest, first);

  const bool whole_rate = std::abs(1 / step - std::round(1 / step)) < 1e-6;
  TraceRow row;
  Eigen::Vector3d left_before = Eigen::Vector3d::UnitZ(), right_before = left_before;
  for (int64_t n = first;; ++n) {
    // thousandths are written as such: 0.3, not 0.30000000000000004
    row.time = whole_rate ? static_cast<double>(n) / std::round(1 / step) : static_cast<double>(n) * step;
    const HeadPose head = world.head(row.time);
    const EyePair eyes = gaze.eyes();
    const Eigen::Quaterniond to_frame = frame == Frame::world ? head.orientation : Eigen::Quaterniond::Identity();
    const Eigen::Vector3d left = to_frame * eyes.left_direction, right = to_frame * eyes.right_direction;
    const Vec2 left_angles = fick_angles(left), right_angles = fick_angles(right);
    row.left_torsion = torsion(eyes.left);
    row.right_torsion = torsion(eyes.right);
    if (n > first) {
      row.left_velocity = signed_angle(left_before, left, left_angles - row.left) / step;
      row.right_velocity = signed_angle(right_before, right, right_angles - row.right) / step;
    }
    row.left = left_angles;
    row.right = right_angles;
    left_before = left;
    right_before = right;
    row.mode = gaze.mode();
    each(row, gaze);

    if (n >= last) return;
    gaze.advance(stimulus(world, gaze));
    if (follows) world.follow(gaze);
  }
}

void write_header(std::ostream& out) {
  out << "t_s,left_azimuth_deg,left_elevation_deg,left_torsion_deg,right_azimuth_deg,right_elevation_deg,"
         "right_torsion_deg,left_velocity_deg_s,right_velocity_deg_s,mode\n";
}

void write_row(std::ostream& out, const TraceRow& row) {
  std::string line;
  objdb::append_number(line, row.time);
  for (double angle : {row.left.x, row.left.y, row.left_torsion, row.right.x, row.right.y, row.right_torsion,
                       row.left_velocity, row.right_velocity}) {
    line += ',';
    // a minus zero would only puzzle the reader
    objdb::append_number(line, angle / deg + 0.0);
  }
  line += ',';
  line += word(row.mode);
  line += '\n';
  out << line;
}

}  // namespace eye
