#pragma once

#include <Eigen/Core>

namespace head {

/// A gaze direction in the frame of the thorax [rad]: yaw about Y, positive to the left; pitch above the horizon.
struct Gaze {
  double yaw = 0, pitch = 0;
};

/// Straight up and straight down have yaw 0.
Gaze gaze(const Eigen::Vector3d& direction);
Eigen::Vector3d direction(const Gaze& gaze);

/// Orientation of a head that looks along `gaze`, by Donders' law: one roll for each direction.
/// roll = 1 is the law of Fick gimbals, which heads obey when the eyes are free to move (Glenn and Vilis 1992; Ceylan
/// et al. 2000): turn about the vertical, then nod, so the eyes stay level. roll = 0 is Listing's law: the shortest way
/// from straight ahead. Between 60 and 85 degrees of pitch Fick's roll fades out, because straight up it winds round.
/// Continuous in front of the shoulders; behind them only for roll = 1 and up to 60 degrees of pitch.
Eigen::Matrix3d donders(const Gaze& gaze, double roll);

/// Orientation of a head that looks against a surface normal (the paper's "normal to the object").
Eigen::Matrix3d facing(const Eigen::Vector3d& normal, double roll);

/// How much of a gaze shift the head takes.
///
/// Horizontally: nothing below `start`, then 0.79 of what goes beyond, which joins the end points of Freedman and
/// Sparks (1997: 0 at 20 degrees, eyes at 35 when gaze is at 90); from there on all that the eyes' comfortable `reach`
/// leaves over. Vertically the same with a third of the slope, after Tweed's gains 0.9 and 0.3. People differ widely
/// (Fuller 1992): the numbers are fields of the neck.
struct Share {
  double start = 0.3490658503988659;  ///< 20 deg
  double yaw = 0.79, pitch = 0.26;    ///< slopes beyond the start
  double reach = 0.6108652381980153;  ///< 35 deg
};

/// The head's part of a gaze. As the gaze goes overhead the yaw fades out, so a target that passes the zenith does not
/// whirl the head round.
Gaze head_part(const Gaze& gaze, const Share& share);

/// How much later than the eyes the head starts for a gaze shift of this size [s]: 139 ms at 10 degrees falling to 50
/// ms at 40, linear between and beyond, never negative (two means of ten people, Jibi to Rinsho 24 supplement 2, 559).
double head_lag(double amplitude);

}  // namespace head
