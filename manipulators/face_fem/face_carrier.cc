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

namespace {

// x y z and a spare number: one register
typedef float Place __attribute__((vector_size(16)));

}  // namespace

void FaceCarrier::carry(const float* node_displacement, float* vertex_displacement) const {
  std::vector<Place> moved(nodes_.size());
  for (std::size_t n = 0; n < moved.size(); ++n)
    moved[n] = Place{node_displacement[3 * n], node_displacement[3 * n + 1], node_displacement[3 * n + 2], 0};
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    Place sum = {0, 0, 0, 0};
    for (int k = start_[v]; k < start_[v + 1]; ++k) sum += weight_[k] * moved[std::size_t(source_[k])];
    for (int i = 0; i < 3; ++i) vertex_displacement[3 * v + std::size_t(i)] = sum[i];
  }
}

}  // namespace face
