#pragma once

#include <vector>

#include "manipulators/face_fem/face_chart.h"
#include "manipulators/face_fem/landmarks.h"

namespace face {

/// Thickness of the soft tissue between skin and bone, square to the skin, over the chart of a face.
class TissueDepth {
 public:
  /// A measured place: a landmark of craniofacial anthropometry.
  struct Site {
    const char* name;
    ChartPoint place;
    double depth;  ///< metres
  };

  /// Places the published sites on a face; see tissue_depth.cc for their sources.
  TissueDepth(const FaceChart& chart, const Landmarks& marks, double scale);

  /// Depth at a chart point, metres: Shepard's mean of the sites, weights falling with the fourth power of distance.
  double at(const ChartPoint& c) const;

  const std::vector<Site>& sites() const { return sites_; }

 private:
  std::vector<Site> sites_;
};

}  // namespace face
