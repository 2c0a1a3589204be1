#include "manipulators/face_fem/strain_watch.h"

#include <Eigen/Dense>
#include <algorithm>

#include "manipulators/face_fem/column_sum.h"
#include "manipulators/face_fem/shape.h"

namespace face {

StrainWatch::StrainWatch(const Model& model, const std::string& without) {
  const auto found = std::find(model.layers.begin(), model.layers.end(), without);
  const int layer = found == model.layers.end() ? -1 : int(found - model.layers.begin());
  for (int e = 0; e < int(model.hexahedra.size()); ++e)
    if (layer < 0 || model.hexahedra[std::size_t(e)].layer != layer) elements_.push_back(e);
}

void StrainWatch::read(const Model& model, const Field& u, int column) {
  if (int(columns_.size()) <= column) columns_.resize(std::size_t(column) + 1);
  std::vector<float>& numbers = columns_[std::size_t(column)];
  const std::size_t count = elements_.size();
  numbers.assign(9 * count, 0);
  const int nodes = nodes_of(model.element);
  double gradient[20][3];
  shape_gradient(nodes, Eigen::Vector3d::Zero(), gradient);
  for (std::size_t k = 0; k < count; ++k) {
    const Corners X = corners_of(model, elements_[k]);
    Corners mine(3, nodes), local(3, nodes);
    for (int a = 0; a < nodes; ++a) {
      mine.col(a) = u.col(model.hexahedra[std::size_t(elements_[k])].node[std::size_t(a)]);
      local.col(a) << gradient[a][0], gradient[a][1], gradient[a][2];
    }
    const Eigen::Matrix3d J = local * X.transpose();
    const Eigen::Matrix3d H = mine * (J.inverse() * local).transpose();
    for (int i = 0; i < 9; ++i) numbers[std::size_t(i) * count + k] = float(H(i / 3, i % 3));
  }
}

Validity StrainWatch::measure(const std::vector<double>& amounts) const {
  Validity validity;
  const std::size_t count = elements_.size();
  std::vector<float> sum(9 * count, 0.0f);
  std::vector<const float*> active;
  std::vector<float> amount;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (amounts[c] == 0 || columns_[c].empty()) continue;
    active.push_back(columns_[c].data());
    amount.push_back(float(amounts[c]));
  }
  add_columns(active.data(), amount.data(), int(active.size()), 9 * count, sum.data());
  for (std::size_t k = 0; k < count; ++k) {
    Eigen::Matrix3f H;
    for (int i = 0; i < 9; ++i) H(i / 3, i % 3) = sum[std::size_t(i) * count + k];
    if (!((Eigen::Matrix3f::Identity() + H).determinant() > 0) && validity.inverted++ == 0)
      validity.inverted_element = elements_[k];
    // no principal strain is larger than the norm, so most elements need no eigenvalues
    const Eigen::Matrix3f strain = (H + H.transpose()) / 2;
    if (double(strain.norm()) <= validity.strain) continue;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
    eigen.computeDirect(strain, Eigen::EigenvaluesOnly);
    const double largest = double(eigen.eigenvalues().cwiseAbs().maxCoeff());
    if (largest > validity.strain) {
      validity.strain = largest;
      validity.strained_element = elements_[k];
    }
  }
  return validity;
}

}  // namespace face
