#include "manipulators/face_fem/face_carrier.h"

#include <algorithm>

namespace face {

FaceCarrier::FaceCarrier(const std::vector<Row>& rows) : start_(1, 0) {
  for (const Row& row : rows) nodes_.insert(nodes_.end(), row.node.begin(), row.node.end());
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  std::vector<const Row*> sorted;
  for (const Row& row : rows) sorted.push_back(&row);
  std::sort(sorted.begin(), sorted.end(), [](const Row* a, const Row* b) { return a->vertex < b->vertex; });
  for (const Row* row : sorted) {
    vertices_.push_back(row->vertex);
    for (std::size_t k = 0; k < row->node.size(); ++k) {
      source_.push_back(int(std::lower_bound(nodes_.begin(), nodes_.end(), row->node[k]) - nodes_.begin()));
      weight_.push_back(row->weight[k]);
    }
    start_.push_back(int(source_.size()));
  }
}

void FaceCarrier::carry(const float* node_displacement, float* vertex_displacement) const {
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    float x = 0, y = 0, z = 0;
    for (int k = start_[v]; k < start_[v + 1]; ++k) {
      const float* u = node_displacement + 3 * source_[k];
      x += weight_[k] * u[0];
      y += weight_[k] * u[1];
      z += weight_[k] * u[2];
    }
    vertex_displacement[3 * v] = x;
    vertex_displacement[3 * v + 1] = y;
    vertex_displacement[3 * v + 2] = z;
  }
}

}  // namespace face
