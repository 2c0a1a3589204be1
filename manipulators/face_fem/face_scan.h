#pragma once

#include <Eigen/Core>
#include <vector>

#include "manipulators/face_fem/face_chart.h"
#include "manipulators/face_fem/head.h"

namespace face {

/// The virtual range scan of a face: skin radius over a regular grid of angles and heights. Narrow dips (the cleft of
/// the mouth, nostrils, gaps beside eyeballs) are bridged, rays that miss take the median of their neighbours.
struct FaceScan {
  FaceChart chart;
  int angles = 0, heights = 0;
  std::vector<double> radius;          ///< height by height: radius[h * angles + a], metres; NaN far from all skin
  std::vector<Eigen::Vector3d> point;  ///< the same as points

  double angle(int a) const { return -chart.side + 2 * chart.side * a / (angles - 1); }
  double height(int h) const { return chart.bottom + (chart.top - chart.bottom) * h / (heights - 1); }
  /// Points within `reach` metres of a chart point, on the chart.
  std::vector<Eigen::Vector3d> near(const ChartPoint& c, double reach) const;
};

/// Scans with rays about `step` metres apart. Cost: about a microsecond a ray.
FaceScan scan_face(const Head& head, const FaceChart& chart, double step);

/// A table `angle_deg,height_m,radius_m,x_m,y_m,z_m`, one row a ray. Error `io`.
Status write_scan(const std::string& path, const FaceScan& scan);

}  // namespace face
