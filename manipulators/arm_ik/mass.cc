#include "manipulators/arm_ik/mass.h"

#include <Eigen/Geometry>

namespace arm_ik {

namespace {

constexpr SegmentRow rows[2][11] = {
    {
        {0.0694, 0.5976, 0.362, 0.376, 0.312},  // head
        {0.4346, 0.4486, 0.372, 0.347, 0.191},  // trunk
        {0.1596, 0.2999, 0.716, 0.454, 0.659},  // upper trunk
        {0.1633, 0.4502, 0.482, 0.383, 0.468},  // middle trunk
        {0.1117, 0.6115, 0.615, 0.551, 0.587},  // lower trunk
        {0.0271, 0.5772, 0.285, 0.269, 0.158},  // upper arm
        {0.0162, 0.4574, 0.276, 0.265, 0.121},  // forearm
        {0.0061, 0.7900, 0.628, 0.513, 0.401},  // hand
        {0.1416, 0.4095, 0.329, 0.329, 0.149},  // thigh
        {0.0433, 0.4395, 0.251, 0.246, 0.102},  // shank
        {0.0137, 0.4415, 0.257, 0.245, 0.124},  // foot
    },
    {
        {0.0668, 0.5894, 0.330, 0.359, 0.318},
        {0.4257, 0.4151, 0.357, 0.339, 0.171},
        {0.1545, 0.2077, 0.746, 0.502, 0.718},
        {0.1465, 0.4512, 0.433, 0.354, 0.415},
        {0.1247, 0.4920, 0.433, 0.402, 0.444},
        {0.0255, 0.5754, 0.278, 0.260, 0.148},
        {0.0138, 0.4559, 0.261, 0.257, 0.094},
        {0.0056, 0.7474, 0.531, 0.454, 0.335},
        {0.1478, 0.3612, 0.369, 0.364, 0.162},
        {0.0481, 0.4352, 0.267, 0.263, 0.092},
        {0.0129, 0.4014, 0.299, 0.279, 0.139},
    },
};

}  // namespace

const SegmentRow& segment_row(Segment segment, Sex sex) {
  return rows[static_cast<std::size_t>(sex)][static_cast<std::size_t>(segment)];
}

MassProperties mass_properties(Segment segment, Sex sex, double body_mass, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& to, const Eigen::Vector3d& forward) {
  const SegmentRow& row = segment_row(segment, sex);
  MassProperties out;
  out.mass = row.mass * body_mass;
  out.center = from + row.center * (to - from);
  const double length = (to - from).norm();
  if (length < 1e-9) return out;
  const Eigen::Vector3d along = (to - from) / length;
  Eigen::Vector3d sagittal = forward - forward.dot(along) * along;
  // a length along `forward` itself: any direction at right angles will do
  if (sagittal.norm() < 1e-6) sagittal = along.unitOrthogonal();
  sagittal.normalize();
  const Eigen::Vector3d transverse = along.cross(sagittal);
  const auto moment = [&](double radius) { return out.mass * radius * radius * length * length; };
  out.inertia = moment(row.sagittal) * sagittal * sagittal.transpose() +
                moment(row.transverse) * transverse * transverse.transpose() +
                moment(row.longitudinal) * along * along.transpose();
  return out;
}

}  // namespace arm_ik
