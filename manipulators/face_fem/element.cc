#include "manipulators/face_fem/element.h"

#include <Eigen/Dense>

#include "manipulators/face_fem/element_batch.h"
#include "manipulators/face_fem/shape.h"

namespace face {
namespace {

using Stress = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// gradients of the shape functions in space at one point, 3 by n, and the determinant
struct Gradient {
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> g;
  double det;
};

Gradient gradient_at(const Corners& X, const double (*dN)[3]) {
  const int n = static_cast<int>(X.cols());
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> local(3, n);
  for (int a = 0; a < n; ++a) local.col(a) << dN[a][0], dN[a][1], dN[a][2];
  const Eigen::Matrix3d J = local * X.transpose();
  return {J.inverse() * local, J.determinant()};
}

Eigen::Matrix<double, 6, 1> hooke(const Eigen::Matrix3d& H, double dilatation, Lame lame) {
  const Eigen::Matrix3d strain = (H + H.transpose()) / 2;
  // mean stress from the given dilatation, the rest from the deviator of the strain
  const Eigen::Matrix3d deviator = strain - strain.trace() / 3 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d s = 2 * lame.mu * deviator + lame.bulk() * dilatation * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 1> stress;
  stress << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
  return stress;
}

double mean_dilatation(const Rule& rule, const Corners& X, const Corners& u) {
  double sum = 0, volume = 0;
  for (int q = 0; q < rule.points; ++q) {
    const Gradient at = gradient_at(X, rule.dN[q]);
    sum += rule.weight[q] * at.det * at.g.cwiseProduct(u).sum();
    volume += rule.weight[q] * at.det;
  }
  return sum / volume;
}

/// strain gradient of the bubbles at a point, 3 by 3: column k belongs to 1 - xi_k^2
Eigen::Matrix3d bubble_gradient(const Corners& X, const Eigen::Vector3d& xi) {
  const Eigen::Matrix3d centre = jacobian(X, Eigen::Vector3d::Zero());
  const double ratio = centre.determinant() / jacobian(X, xi).determinant();
  return ratio * centre.inverse() * (-2 * xi).asDiagonal();
}

/// amplitudes of the three bubbles (3 by 3, column k the displacement of bubble k) that make their own forces vanish
Eigen::Matrix3d bubble_amplitudes(const Rule& rule, const Corners& X, const Corners& u, Lame lame) {
  Eigen::Matrix<double, 9, 9> K = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> force = Eigen::Matrix<double, 9, 1>::Zero();
  for (int q = 0; q < rule.points; ++q) {
    const Gradient at = gradient_at(X, rule.dN[q]);
    const Eigen::Matrix3d G = bubble_gradient(X, rule.xi[q]);
    const double weight = rule.weight[q] * at.det;
    const Eigen::Matrix3d H = u * at.g.transpose(), strain = (H + H.transpose()) / 2;
    const Eigen::Matrix3d stress = 2 * lame.mu * strain + lame.lambda * strain.trace() * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
      force.segment<3>(3 * k) += weight * stress * G.col(k);
      for (int l = 0; l < 3; ++l)
        K.block<3, 3>(3 * k, 3 * l) +=
            weight * (lame.lambda * G.col(k) * G.col(l).transpose() + lame.mu * G.col(l) * G.col(k).transpose() +
                      lame.mu * G.col(k).dot(G.col(l)) * Eigen::Matrix3d::Identity());
    }
  }
  const Eigen::Matrix<double, 9, 1> amplitude = -K.ldlt().solve(force);
  return Eigen::Map<const Eigen::Matrix3d>(amplitude.data());
}

/// values at the nodes of the polynomial through the points of a tensor rule: #points by 20, the transpose of
/// extrapolation; mid-edge nodes take the mean of their corners
Eigen::MatrixXd extrapolation(int per_axis) {
  const Line& line = gauss_line(per_axis);
  const auto lagrange = [&](int i, double x) {
    double value = 1;
    for (int k = 0; k < per_axis; ++k)
      if (k != i) value *= (x - line.position[k]) / (line.position[i] - line.position[k]);
    return value;
  };
  Eigen::MatrixXd E(per_axis * per_axis * per_axis, 20);
  for (int a = 0; a < 8; ++a) {
    const Eigen::Vector3d& xi = reference_nodes()[a];
    int q = 0;
    for (int k = 0; k < per_axis; ++k)
      for (int j = 0; j < per_axis; ++j)
        for (int i = 0; i < per_axis; ++i) E(q++, a) = lagrange(i, xi.x()) * lagrange(j, xi.y()) * lagrange(k, xi.z());
  }
  static constexpr int ends[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  for (int edge = 0; edge < 12; ++edge) E.col(8 + edge) = (E.col(ends[edge][0]) + E.col(ends[edge][1])) / 2;
  return E;
}

}  // namespace

std::string_view name_of(Element element) {
  static constexpr std::array<std::string_view, 5> names = {"hex8", "bbar", "wt", "hex20", "hex20r"};
  return names[static_cast<std::size_t>(element)];
}

std::optional<Element> element_named(std::string_view name) {
  for (Element element : all_elements)
    if (name_of(element) == name) return element;
  return std::nullopt;
}

Eigen::MatrixXd stiffness_of(Element element, const Corners& X, Lame lame) {
  const int n = nodes_of(element);
  Batch batch;
  for (int lane = 0; lane < lanes; ++lane) {
    for (int a = 0; a < n; ++a)
      for (int i = 0; i < 3; ++i) batch.X[a][i][lane] = X(i, a);
    batch.lambda[lane] = lame.lambda;
    batch.mu[lane] = lame.mu;
  }
  fill_stiffness(element, batch);
  Eigen::MatrixXd K(3 * n, 3 * n);
  for (int a = 0; a < n; ++a)
    for (int b = 0; b <= a; ++b)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          K(3 * a + i, 3 * b + j) = K(3 * b + j, 3 * a + i) = batch.K[pair_index(a, b)][i][j][0];
  return K;
}

Stress point_stress(Element element, const Corners& X, const Corners& u, Lame lame) {
  const Rule& rule = rule_of(element);
  const double mean = element == Element::bbar ? mean_dilatation(rule, X, u) : 0;
  const Eigen::Matrix3d amplitude =
      element == Element::wt ? bubble_amplitudes(rule, X, u, lame) : Eigen::Matrix3d::Zero().eval();
  Stress stress(6, rule.points);
  for (int q = 0; q < rule.points; ++q) {
    Eigen::Matrix3d H = u * gradient_at(X, rule.dN[q]).g.transpose();
    if (element == Element::wt) H += amplitude * bubble_gradient(X, rule.xi[q]).transpose();
    stress.col(q) = hooke(H, element == Element::bbar ? mean : H.trace(), lame);
  }
  return stress;
}

Stress nodal_stress(Element element, const Corners& X, const Corners& u, Lame lame) {
  static const Eigen::MatrixXd from2 = extrapolation(2), from3 = extrapolation(3);
  const Stress points = point_stress(element, X, u, lame);
  return points * (points.cols() == 8 ? from2 : from3).leftCols(nodes_of(element));
}

}  // namespace face
