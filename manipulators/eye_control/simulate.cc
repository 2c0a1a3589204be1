#include "manipulators/eye_control/simulate.h"

#include <cmath>
#include <ostream>

#include "objdb/text.h"

namespace eye {

using objdb::ErrorKind;
using objdb::Status;

namespace {

// the columns every course of angles needs; -1 for a missing one
struct Columns {
  int time, azimuth, elevation, distance;
};

objdb::Result<Columns> columns_of(const Table& table, const std::string& name) {
  const Columns c{table.column("t_s"), table.column("azimuth_deg"), table.column("elevation_deg"),
                  table.column("distance_m")};
  for (const auto& [index, wanted] :
       {std::pair{c.time, "t_s"}, std::pair{c.azimuth, "azimuth_deg"}, std::pair{c.elevation, "elevation_deg"}}) {
    if (index < 0) {
      return cell_error(name, 1, 1, ErrorKind::unknown,
                        "column " + std::string(wanted) + " is missing, expected t_s,azimuth_deg,elevation_deg");
    }
  }
  if (table.rows.empty()) return cell_error(name, 1, 1, ErrorKind::syntax, "the table has a header but no rows");
  return c;
}

Status check_time(const Table& table, size_t row, int column, const std::string& name) {
  const double time = table.rows[row][static_cast<size_t>(column)];
  if (std::isnan(time))
    return cell_error(name, table.lines[row], 1, ErrorKind::type, "t_s is empty, expected a number");
  if (std::abs(time) > 1e6) {
    return cell_error(name, table.lines[row], 1, ErrorKind::range,
                      "t_s must be within 1000000 s, not " + objdb::number(time));
  }
  if (row > 0 && time < table.rows[row - 1][static_cast<size_t>(column)]) {
    return cell_error(name, table.lines[row], 1, ErrorKind::range,
                      "t_s must not fall, but " + objdb::number(time) + " follows " +
                          objdb::number(table.rows[row - 1][static_cast<size_t>(column)]));
  }
  return {};
}

Status check_elevation(double elevation, int line, const std::string& name) {
  if (std::abs(elevation) <= 90) return {};
  return cell_error(name, line, 1, ErrorKind::range,
                    "elevation_deg must be between -90 and 90, not " + objdb::number(elevation));
}

// angle between two directions, with the sign of the larger component of the change
double signed_angle(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Vec2 change) {
  const double size = std::atan2(from.cross(to).norm(), from.dot(to));
  const double larger = std::abs(change.x) >= std::abs(change.y) ? change.x : change.y;
  return std::copysign(size, larger);
}

}  // namespace

Status fill_target(Track& track, const Table& table, const std::string& name) {
  const auto c = columns_of(table, name);
  if (!c) return c.error();
  for (size_t k = 0; k < table.rows.size(); ++k) {
    if (Status status = check_time(table, k, c->time, name); !status) return status;
    const auto& row = table.rows[k];
    const auto cell = [&](int column) { return row[static_cast<size_t>(column)]; };
    const double azimuth = cell(c->azimuth), elevation = cell(c->elevation);
    if (std::isnan(azimuth) || std::isnan(elevation)) {
      track.add(cell(c->time), Eigen::Vector3d::Zero(), false);
      continue;
    }
    if (Status status = check_elevation(elevation, table.lines[k], name); !status) return status;
    double nearness = 0;
    if (c->distance >= 0 && !std::isnan(cell(c->distance))) {
      const double distance = cell(c->distance);
      if (!(distance > 0)) {
        return cell_error(name, table.lines[k], 1, ErrorKind::range,
                          "distance_m must be positive, not " + objdb::number(distance));
      }
      nearness = 1 / distance;
    }
    track.add(cell(c->time), {azimuth * deg, elevation * deg, nearness});
  }
  return {};
}

Status fill_head(Track& track, const Table& table, const std::string& name) {
  const auto c = columns_of(table, name);
  if (!c) return c.error();
  for (size_t k = 0; k < table.rows.size(); ++k) {
    if (Status status = check_time(table, k, c->time, name); !status) return status;
    const auto& row = table.rows[k];
    const double azimuth = row[static_cast<size_t>(c->azimuth)], elevation = row[static_cast<size_t>(c->elevation)];
    if (std::isnan(azimuth) || std::isnan(elevation)) {
      return cell_error(name, table.lines[k], 1, ErrorKind::type, "a head angle is empty, expected a number");
    }
    if (Status status = check_elevation(elevation, table.lines[k], name); !status) return status;
    track.add(row[static_cast<size_t>(c->time)], {azimuth * deg, elevation * deg, 0});
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
    const Gaze::Eyes eyes = gaze.eyes();
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
