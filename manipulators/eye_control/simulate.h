#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "manipulators/eye_control/csv.h"
#include "manipulators/eye_control/head_follow.h"
#include "objdb/result.h"

namespace eye {

/// Both eyes at one moment. Directions are Fick angles, rad, right and up positive.
struct TraceRow {
  double time = 0;
  Vec2 left, right;                            ///< in the world, or in the head (`Frame`)
  double left_torsion = 0, right_torsion = 0;  ///< in Listing's coordinates of the head, rad
  /// angle per time over the step before, in the same frame, rad/s; its sign is that of the larger of the changes to
  /// the right and up
  double left_velocity = 0, right_velocity = 0;
  Mode mode = Mode::fixation;
};

/// What directions of a trace are relative to.
enum class Frame { world, head };

/// Fills target and head track from tables (`t_s,azimuth_deg,elevation_deg[,distance_m]`; an empty cell of a target is
/// "not visible"). Errors: unknown (missing column), type (empty cell where a number is needed), range (time not
/// rising, elevation beyond 90 deg, distance not positive), each with its place.
objdb::Status fill_target(Track& track, const Table& table, const std::string& name);
objdb::Status fill_head(Track& track, const Table& table, const std::string& name);

/// Runs a pair of eyes over the target's whole time, at rest on its first visible place before. `each` is called for
/// the start and after every internal step.
void simulate(FollowingWorld& world, std::shared_ptr<const Parameters> parameters, Frame frame,
              const std::function<void(const TraceRow&, const Gaze&)>& each);

/// The header of a trace file, and its lines: shortest numbers that read back to the same bits.
void write_header(std::ostream& out);
void write_row(std::ostream& out, const TraceRow& row);

}  // namespace eye
