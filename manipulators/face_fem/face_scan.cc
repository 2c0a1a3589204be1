#include "manipulators/face_fem/face_scan.h"

#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/text_file.h"

namespace face {
namespace {

/// median of the finite values within two steps of a place, NaN when there are none
double median_near(const FaceScan& scan, int a, int h) {
  std::vector<double> around;
  for (int y = std::max(0, h - 2); y <= std::min(scan.heights - 1, h + 2); ++y)
    for (int x = std::max(0, a - 2); x <= std::min(scan.angles - 1, a + 2); ++x)
      if (const double r = scan.radius[y * scan.angles + x]; std::isfinite(r)) around.push_back(r);
  if (around.empty()) return NAN;
  std::nth_element(around.begin(), around.begin() + around.size() / 2, around.end());
  return around[around.size() / 2];
}

}  // namespace

FaceScan scan_face(const Head& head, const FaceChart& chart, double step) {
  FaceScan scan;
  scan.chart = chart;
  scan.angles = 1 + int(std::ceil(2 * chart.side * FaceChart::nominal / step));
  scan.heights = 1 + int(std::ceil((chart.top - chart.bottom) / step));
  for (int h = 0; h < scan.heights; ++h)
    for (int a = 0; a < scan.angles; ++a)
      scan.radius.push_back(
          head.outermost(chart.origin(scan.height(h)), chart.direction(scan.angle(a), scan.height(h))).value_or(NAN));
  const FaceScan raw = scan;
  for (int h = 0; h < scan.heights; ++h)
    for (int a = 0; a < scan.angles; ++a) {
      double& r = scan.radius[h * scan.angles + a];
      const double median = median_near(raw, a, h);
      if (!(r > median - 0.004)) r = median;
      scan.point.push_back(chart.point({scan.angle(a), scan.height(h), r}));
    }
  return scan;
}

std::vector<Eigen::Vector3d> FaceScan::near(const ChartPoint& c, double reach) const {
  const double per_angle = (angles - 1) / (2 * chart.side), per_height = (heights - 1) / (chart.top - chart.bottom);
  const double a = (c.angle + chart.side) * per_angle, h = (c.height - chart.bottom) * per_height;
  const double da = reach / FaceChart::nominal * per_angle, dh = reach * per_height;
  std::vector<Eigen::Vector3d> found;
  for (int y = std::max(0, int(h - dh)); y <= std::min(heights - 1, int(h + dh)); ++y)
    for (int x = std::max(0, int(a - da)); x <= std::min(angles - 1, int(a + da)); ++x)
      if (std::isfinite(radius[y * angles + x])) found.push_back(point[y * angles + x]);
  return found;
}

Status write_scan(const std::string& path, const FaceScan& scan) {
  TextFile file;
  file.add("angle_deg,height_m,radius_m,x_m,y_m,z_m\n");
  for (int h = 0; h < scan.heights; ++h)
    for (int a = 0; a < scan.angles; ++a) {
      const std::size_t k = std::size_t(h) * scan.angles + a;
      const Eigen::Vector3d& p = scan.point[k];
      char line[200];
      std::snprintf(line, sizeof line, "%.4f,%.6f,%.6f,%.6f,%.6f,%.6f\n", scan.angle(a) * 180 / M_PI, scan.height(h),
                    scan.radius[k], p.x(), p.y(), p.z());
      file.add(line);
    }
  return file.write(path);
}

}  // namespace face
