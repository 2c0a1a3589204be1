#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "manipulators/face_fem/face_chart.h"
#include "manipulators/face_fem/landmarks.h"

namespace face {

/// A cut along one row of a sheet: the stacks of columns first + 1 .. last - 1 are doubled.
struct Cut {
  int row = 0, first = 0, last = 0;
};

/// The face as a sheet of columns by rows quadrilaterals on the chart, cut along mouth and eyes. Its corners are
/// called stacks, for tissue is stacked on them. Column 0 is the person's right, row 0 lies under the chin.
struct FaceSheet {
  FaceChart chart;
  int columns = 0, rows = 0;
  std::vector<ChartPoint> stacks;  ///< radius is that of the skin
  /// For each corner (j (columns + 1) + i) the stack that a quadrilateral above (below) row j uses; they differ in
  /// cuts.
  std::vector<int> above, below;
  Cut mouth;
  std::array<Cut, 2> eyes;  ///< left, right

  /// For each quadrilateral (j columns + i) and then for each row of them the box round it on the flat chart
  /// (nominal x angle, height), metres: what locate() looks at first.
  std::vector<Eigen::AlignedBox2d> quad_box, row_box;

  int corner(int i, int j) const { return j * (columns + 1) + i; }
  /// The four stacks of a quadrilateral: right below, left below, left above, right above.
  std::array<int, 4> quad(int i, int j) const {
    return {above[corner(i, j)], above[corner(i + 1, j)], below[corner(i + 1, j + 1)], below[corner(i, j + 1)]};
  }
};

/// Where a chart point lies in a sheet: 0 <= i < columns plus a share, likewise rows; clamped to the sheet.
struct SheetPlace {
  int i = 0, j = 0;
  double u = 0, v = 0;  ///< in [0, 1] within the quadrilateral
  double miss = 0;      ///< distance on the chart from the sheet, metres; 0 inside
};

/// Which side of a cut a point belongs to.
enum class CutSide { any, above, below };

/// The nearest place of the sheet; with a side, only quadrilaterals above (below) that row are looked at.
SheetPlace locate(const FaceSheet& sheet, const ChartPoint& point, CutSide side = CutSide::any, int row = 0);

/// Lays the sheet on a head. `columns` even. Rows and columns are finer round mouth and eyes.
/// Errors: `inverted` a quadrilateral that folds, `mesh` a hole in the skin.
Result<FaceSheet> lay_sheet(const Head& head, const Landmarks& marks, int columns, int rows);

}  // namespace face
