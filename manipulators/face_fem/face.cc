#include "manipulators/face_fem/face.h"

#include <algorithm>
#include <sstream>

#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/face_binding.h"
#include "manipulators/face_fem/face_muscles.h"
#include "manipulators/face_fem/face_sheet.h"
#include "manipulators/face_fem/face_tissue.h"
#include "manipulators/face_fem/head.h"
#include "manipulators/face_fem/landmarks.h"

namespace face {
namespace {

Status check_options(const FaceOptions& options) {
  const auto refuse = [](const std::string& sentence) { return Error{Fault::limit, sentence}; };
  if (options.columns < 16 || options.columns > 128 || options.columns % 2 != 0)
    return refuse("columns must be an even number from 16 to 128, is " + std::to_string(options.columns));
  if (options.rows < 16 || options.rows > 128)
    return refuse("rows must be a number from 16 to 128, is " + std::to_string(options.rows));
  if (options.layers < 3 || options.layers > 12)
    return refuse("layers must be a number from 3 to 12, is " + std::to_string(options.layers));
  if (nodes_of(options.element) != 8) return refuse("a face is built of 8-node elements");
  if (!(options.depth_scale > 0.2 && options.depth_scale < 3))
    return refuse("depth_scale must lie between 0.2 and 3, is " + std::to_string(options.depth_scale));
  if (!(options.reach > 0.001 && options.reach < 0.3))
    return refuse("reach must lie between 0.001 and 0.3 m, is " + std::to_string(options.reach));
  return success();
}

Slit slit_of(const FaceSheet& sheet, const FaceTissue& tissue, const Cut& cut) {
  Slit slit;
  slit.columns = cut.last - cut.first - 1;
  slit.levels = int(tissue.node.front().size());
  for (int i = cut.first; i <= cut.last; ++i) {
    const int upper = sheet.above[sheet.corner(i, cut.row)], lower = sheet.below[sheet.corner(i, cut.row)];
    slit.upper_margin.push_back(tissue.node[upper].back());
    slit.lower_margin.push_back(tissue.node[lower].back());
    if (upper == lower) continue;
    // along the slit and along the ray: square to both
    const auto next = [&](int step, const std::vector<int>& side) {
      return sheet.chart.point(sheet.stacks[side[sheet.corner(i + step, cut.row)]]);
    };
    const Eigen::Vector3d along =
        next(1, sheet.above) + next(1, sheet.below) - next(-1, sheet.above) - next(-1, sheet.below);
    const ChartPoint& c = sheet.stacks[lower];
    const Eigen::Vector3d normal = sheet.chart.direction(c.angle, c.height).cross(along).normalized();
    for (int level = 0; level < slit.levels; ++level)
      slit.pairs.push_back({tissue.node[upper][level], tissue.node[lower][level], i - cut.first - 1, level, normal});
  }
  return slit;
}

}  // namespace

const Landmark& Face::landmark(const std::string& name) const {
  return *std::find_if(landmarks.begin(), landmarks.end(), [&](const Landmark& l) { return l.name == name; });
}

int Face::muscle(const std::string& name) const {
  for (std::size_t k = 0; k < muscles.size(); ++k)
    if (muscles[k].name == name) return int(k);
  return -1;
}

Result<Face> build_face(const mesh::Surface& surface, const FaceOptions& options) {
  if (auto status = check_options(options); !status) return status.error();
  const auto head = Head::take(surface);
  if (!head) return head.error();
  auto marks = find_landmarks(*head, options.landmarks);
  if (!marks) return marks.error();
  const auto sheet = lay_sheet(*head, *marks, options.columns, options.rows);
  if (!sheet) return sheet.error();
  FaceTissue tissue = stack_tissue(*head, *marks, *sheet, options);
  if (auto status = check(tissue.model); !status) return status.error();
  if (const auto turned = turned_corners(tissue.model); !turned.empty()) {
    const Eigen::Vector3d& p = tissue.model.nodes[turned.front().node];
    std::ostringstream text;
    text << turned.size() << " elements fold, the first at (" << p.transpose() << ")";
    return Error{Fault::inverted, text.str(), turned.front().node};
  }

  Face face;
  place_muscles(*marks, *sheet, tissue, face.muscles, face.muscle_notes);
  face.carrier = FaceCarrier(bind_vertices(*head, *marks, *sheet, tissue, options.reach));
  face.lips = slit_of(*sheet, tissue, sheet->mouth);
  for (int eye : {0, 1}) face.lids[eye] = slit_of(*sheet, tissue, sheet->eyes[eye]);
  face.eyes = marks->eyes;
  const Eigen::Vector3d left = marks->at("left_jaw_joint"), right = marks->at("right_jaw_joint");
  face.jaw = {(left + right) / 2, (left - right).normalized()};
  face.model = std::move(tissue.model);
  for (const Landmark& mark : marks->points)
    if (mark.confidence <= 0.5 && mark.source == "proportion")
      face.notes.push_back("landmark " + mark.name + " is guessed from proportions");
  face.landmarks = std::move(marks->points);
  return face;
}

}  // namespace face
