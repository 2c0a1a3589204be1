#pragma once

namespace face {

/// Share of the way at share s of the time along the course of least jerk between two rests (Flash and Hogan 1985):
/// 10 s^3 - 15 s^4 + 6 s^5, 0 before and 1 after. Velocity and acceleration are zero at both ends.
double least_jerk(double s);

/// Rise, apex and fall of a gesture on simulated time, seconds.
struct Envelope {
  static constexpr double held = -1;  ///< end of a gesture that stays until it is relaxed

  double begin = 0;   ///< where the rise begins
  double onset = 0;   ///< its length
  double end = held;  ///< where the fall begins; not before `begin`
  double offset = 0;  ///< its length

  /// 0 before `begin`, 1 at the apex, 0 after the fall. A fall that begins within the rise multiplies it, so the level
  /// stays as smooth as least_jerk.
  double at(double time) const;
  bool over(double time) const { return end != held && time >= end + offset; }
};

}  // namespace face
