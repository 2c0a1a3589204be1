#include "manipulators/face_fem/neo_hookean.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "manipulators/face_fem/check.h"
#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/shape.h"
#include "manipulators/face_fem/statics.h"
#include "manipulators/face_fem/validity.h"

namespace face {
namespace {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Constants of the energy: a pointwise part (mu, lambda, alpha) and, for bbar, a bulk modulus on the mean of J.
/// Linearised at rest the pointwise part has Lame's constants 3/4 mu and lambda - 5/8 mu, and no stress when
/// alpha = 1 + 3/4 mu / lambda.
struct Law {
  double mu, lambda, alpha, mean_bulk;

  Law(Lame lame, bool mean) : mu(4.0 / 3 * lame.mu), mean_bulk(mean ? lame.bulk() : 0) {
    // with the dilatation in the mean the pointwise part keeps the deviator: lambda - 5/8 mu = -2/3 of Lame's mu
    lambda = mean ? lame.mu / 6 : lame.lambda + 5.0 / 6 * lame.mu;
    alpha = 1 + 0.75 * mu / lambda;
  }

  double density(const Mat3& F) const {
    const double I = F.squaredNorm(), J = F.determinant(), miss = J - alpha;
    return mu / 2 * (I - 3) + lambda / 2 * miss * miss - mu / 2 * std::log(I + 1);
  }
  /// so that rest has no energy
  double at_rest() const { return lambda / 2 * (1 - alpha) * (1 - alpha) - mu / 2 * std::log(4.0); }
};

Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C.col(0) = F.col(1).cross(F.col(2));
  C.col(1) = F.col(2).cross(F.col(0));
  C.col(2) = F.col(0).cross(F.col(1));
  return C;
}

/// second derivative of the density in the frame of the singular vectors F = U diag(s) V^T: direct couples
/// stretches, and each pair of axes has [[plain, cross], [cross, plain]] on (u_i v_j^T, u_j v_i^T)
struct Curvature {
  Mat3 U, V, direct, plain, cross;
};

Curvature curvature_of(const Law& law, const Mat3& F, double mean_pressure, bool project) {
  Curvature c;
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  c.U = svd.matrixU();
  c.V = svd.matrixV();
  Vec3 s = svd.singularValues();
  if (c.U.determinant() < 0) c.U.col(2) *= -1, s[2] *= -1;
  if (c.V.determinant() < 0) c.V.col(2) *= -1, s[2] *= -1;
  const double I = s.squaredNorm(), J = s[0] * s[1] * s[2];
  const double a = law.mu * (1 - 1 / (I + 1)), b = law.lambda * (J - law.alpha) + mean_pressure;
  const Vec3 slope(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
  c.direct = a * Mat3::Identity() + 2 * law.mu / ((I + 1) * (I + 1)) * s * s.transpose() +
             law.lambda * slope * slope.transpose();
  c.plain.setZero();
  c.cross.setZero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const double third = s[3 - i - j];
      c.direct(i, j) += b * third;
      double flip = a - b * third, twist = a + b * third;
      if (project) flip = std::max(flip, 0.0), twist = std::max(twist, 0.0);
      c.plain(i, j) = (flip + twist) / 2;
      c.cross(i, j) = (flip - twist) / 2;
    }
  if (project) {
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.compute(c.direct);
    c.direct = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
  }
  return c;
}

/// what never changes: gradients and weights at the integration points of every element
class Tissue {
 public:
  explicit Tissue(const Model& model) : model_(model), rule_(rule_of(model.element)) {
    const int n = rule_.nodes;
    gradient_.resize(3, Eigen::Index(n) * rule_.points * model.hexahedra.size());
    weight_.resize(rule_.points * model.hexahedra.size());
    for (int e = 0; e < int(model.hexahedra.size()); ++e) {
      const Corners X = corners_of(model, e);
      for (int q = 0; q < rule_.points; ++q) {
        Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> local(3, n);
        for (int a = 0; a < n; ++a) local.col(a) << rule_.dN[q][a][0], rule_.dN[q][a][1], rule_.dN[q][a][2];
        const Mat3 J = local * X.transpose();
        gradient_.middleCols(at(e, q) * n, n) = J.inverse() * local;
        weight_[at(e, q)] = rule_.weight[q] * J.determinant();
      }
    }
  }

  double energy(const Field& u) const {
    double sum = 0;
    Field none;
    for (int e = 0; e < elements(); ++e) sum += element(e, u, nullptr, nullptr, false);
    return sum;
  }

  /// energy, with force and Hessian added up where wanted
  double state(const Field& u, Field* force, Stiffness* K, bool project) const {
    double sum = 0;
    if (force != nullptr) *force = Field::Zero(3, u.cols());
    if (K != nullptr) std::fill(K->block.begin(), K->block.end(), 0.0);
    for (int e = 0; e < elements(); ++e) sum += element(e, u, force, K, project);
    return sum;
  }

 private:
  int elements() const { return int(model_.hexahedra.size()); }
  Eigen::Index at(int e, int q) const { return Eigen::Index(e) * rule_.points + q; }

  double element(int e, const Field& u, Field* force, Stiffness* K, bool project) const {
    const int n = rule_.nodes;
    const Hexahedron& h = model_.hexahedra[e];
    const bool mean = model_.element == Element::bbar;
    const Law law(model_.materials[h.material].lame(), mean);
    Corners mine(3, n);
    for (int a = 0; a < n; ++a) mine.col(a) = u.col(h.node[a]);
    std::array<Mat3, 27> F;
    double energy = 0, volume = 0, moved = 0;
    for (int q = 0; q < rule_.points; ++q) {
      F[q] = Mat3::Identity() + mine * gradient(e, q).transpose();
      const double w = weight_[at(e, q)];
      energy += w * (law.density(F[q]) - law.at_rest());
      volume += w;
      moved += w * F[q].determinant();
    }
    const double swell = moved / volume - 1, pressure = law.mean_bulk * swell;
    energy += law.mean_bulk * volume / 2 * swell * swell;
    if (force != nullptr || K != nullptr) derivatives(e, h, law, F, volume, pressure, force, K, project);
    return energy;
  }

  Eigen::Ref<const Eigen::Matrix3Xd> gradient(int e, int q) const {
    return gradient_.middleCols(at(e, q) * rule_.nodes, rule_.nodes);
  }

  void derivatives(int e, const Hexahedron& h, const Law& law, const std::array<Mat3, 27>& F, double volume,
                   double pressure, Field* force, Stiffness* K, bool project) const {
    const int n = rule_.nodes;
    std::array<Mat3, 210> block;
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> swelling = Eigen::Matrix3Xd::Zero(3, n);
    if (K != nullptr) std::fill(block.begin(), block.begin() + n * (n + 1) / 2, Mat3::Zero());
    for (int q = 0; q < rule_.points; ++q) {
      const double w = weight_[at(e, q)];
      const auto g = gradient(e, q);
      const Mat3 C = cofactor(F[q]);
      if (force != nullptr) {
        const double I = F[q].squaredNorm(), J = F[q].determinant();
        const Mat3 P = law.mu * (1 - 1 / (I + 1)) * F[q] + (law.lambda * (J - law.alpha) + pressure) * C;
        for (int a = 0; a < n; ++a) force->col(h.node[a]) += w * P * g.col(a);
      }
      if (K == nullptr) continue;
      if (law.mean_bulk > 0) swelling += w * C * g;
      add_curvature(curvature_of(law, F[q], pressure, project), w, g, block);
    }
    if (K == nullptr) return;
    for (int a = 0, p = 0; a < n; ++a)
      for (int b = 0; b <= a; ++b, ++p) {
        if (law.mean_bulk > 0) block[p] += law.mean_bulk / volume * swelling.col(a) * swelling.col(b).transpose();
        scatter(h.node[a], h.node[b], a != b, block[p], *K);
      }
  }

  /// adds w times the second derivative for each pair of nodes
  void add_curvature(const Curvature& c, double w, const Eigen::Ref<const Eigen::Matrix3Xd>& g,
                     std::array<Mat3, 210>& block) const {
    const int n = rule_.nodes;
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 20> turned = c.V.transpose() * g;
    for (int a = 0, p = 0; a < n; ++a)
      for (int b = 0; b <= a; ++b, ++p) {
        const Vec3 ga = w * turned.col(a), gb = turned.col(b);
        Mat3 k;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            if (i != j) {
              k(i, j) = c.direct(i, j) * ga[i] * gb[j] + c.cross(i, j) * ga[j] * gb[i];
              continue;
            }
            const int l = (i + 1) % 3, m = (i + 2) % 3;
            k(i, i) = c.direct(i, i) * ga[i] * gb[i] + c.plain(i, l) * ga[l] * gb[l] + c.plain(i, m) * ga[m] * gb[m];
          }
        block[p] += c.U * k * c.U.transpose();
      }
  }

  static void scatter(int na, int nb, bool distinct, const Mat3& block, Stiffness& K) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> to(
        K.block.data() + 9 * std::size_t(K.entry(std::max(na, nb), std::min(na, nb))));
    if (na > nb || !distinct)
      to += block;
    else if (na < nb)
      to += block.transpose();
    else
      to += block + block.transpose();
  }

  const Model& model_;
  const Rule& rule_;
  Eigen::Matrix3Xd gradient_;
  std::vector<double> weight_;
};

/// one increment after the other, Newton inside
class Search {
 public:
  Search(const Model& model, Stiffness pattern, Factor factor, const Field& load, const Field& shift,
         const NonlinearOptions& options)
      : model_(model),
        tissue_(model),
        held_(held_axes(model)),
        K_(std::move(pattern)),
        factor_(std::move(factor)),
        load_(load),
        shift_(only_held(shift)),
        options_(options) {}

  NonlinearSolution run() {
    const double begin = cpu_seconds();
    solution_.u = Field::Zero(3, load_.cols());
    double step = 1.0 / increments();
    for (int halved = 0; solution_.reached < 1;) {
      const double target = std::min(1.0, solution_.reached + step);
      Field u = solution_.u;
      if (increment(u, solution_.reached, target >= 1 - 1e-12 ? 1 : target)) {
        solution_.u = u;
        solution_.reached = target >= 1 - 1e-12 ? 1 : target;
        ++solution_.increments;
      } else if (++halved > options_.most_halvings) {
        solution_.status = Convergence::increments;
        break;
      } else {
        step /= 2;
      }
    }
    Field force;
    solution_.energy =
        tissue_.state(solution_.u, &force, nullptr, false) - solution_.reached * load_.cwiseProduct(solution_.u).sum();
    solution_.residual = left(force, solution_.reached);
    solution_.reaction = only_held(force - solution_.reached * load_);
    solution_.seconds = cpu_seconds() - begin;
    return solution_;
  }

 private:
  int increments() const {
    if (options_.increments > 0) return options_.increments;
    double turn = 0;
    for (int bone = 0; bone < std::max<int>(1, int(model_.bones.size())); ++bone)
      turn = std::max(turn, bone_turn(model_, shift_, bone));
    return std::max(1, int(std::ceil(turn / (5 * 3.14159265358979323846 / 180) - 1e-9)));
  }

  Field only_held(const Field& f) const {
    Field kept = Field::Zero(3, f.cols());
    for (int n = 0; n < f.cols(); ++n)
      for (int i = 0; i < 3; ++i)
        if (held_[n][i]) kept(i, n) = f(i, n);
    return kept;
  }

  /// force that is left over the free axes, relative to what acts
  double left(const Field& force, double part) const {
    double miss = 0, acting = 0;
    for (int n = 0; n < force.cols(); ++n)
      for (int i = 0; i < 3; ++i) {
        const double outside = part * load_(i, n), rest = force(i, n) - outside;
        if (!held_[n][i]) miss += rest * rest;
        acting += held_[n][i] ? rest * rest : outside * outside;
      }
    return acting > 0 ? std::sqrt(miss / acting) : std::sqrt(miss);
  }

  /// factors the Hessian at u: exact where that is positive definite and wanted, else its positive part
  bool factor_at(const Field& u, bool exact) {
    if (exact) {
      tissue_.state(u, nullptr, &K_, false);
      if (factor_.refactor(K_)) return true;
    }
    tissue_.state(u, nullptr, &K_, true);
    return bool(factor_.refactor(K_));
  }

  /// moves u from one part of the load to another; false when it does not converge
  bool increment(Field& u, double from, double to) {
    // predictor: the tangent answer to the step of load and shift
    if (!factor_at(u, true)) return false;
    const Field given = (to - from) * shift_;
    u += factor_.solve((to - from) * load_ - multiply(K_, given)) + given;
    if (!u.allFinite()) return false;
    double before = HUGE_VAL;
    for (int k = 0; k < options_.most_iterations; ++k) {
      Field force;
      const double energy = tissue_.state(u, &force, nullptr, false) - to * load_.cwiseProduct(u).sum();
      const double rest = left(force, to);
      if (!std::isfinite(rest)) return false;
      if (rest <= options_.tolerance) return true;
      // at the floor of rounding nothing more is won
      if (rest < 100 * options_.tolerance && rest > 0.9 * before) return rest <= 10 * options_.tolerance;
      before = rest;
      ++solution_.iterations;
      if (!factor_at(u, rest < 0.2)) return false;
      const Field step = factor_.solve(to * load_ - force);
      const double slope = (force - to * load_).cwiseProduct(step).sum();
      if (!search_line(u, step, slope, energy, to)) return false;
    }
    return false;
  }

  /// shortens the step until the energy falls
  bool search_line(Field& u, const Field& step, double slope, double energy, double part) const {
    const double noise = 1e-13 * (std::abs(energy) + std::abs(slope));
    for (double length = 1; length > 1e-6; length /= 2) {
      const Field next = u + length * step;
      const double there = tissue_.energy(next) - part * load_.cwiseProduct(next).sum();
      if (there <= energy + 1e-4 * length * slope + noise) {
        u = next;
        return true;
      }
    }
    return false;
  }

  const Model& model_;
  Tissue tissue_;
  std::vector<std::array<bool, 3>> held_;
  Stiffness K_;
  Factor factor_;
  Field load_, shift_;
  NonlinearOptions options_;
  NonlinearSolution solution_;
};

Status can_do(const Model& model) {
  if (model.element == Element::wt)
    return Error{Fault::element, "wt is for small strain: its bubbles are unstable in large strain; use bbar"};
  return check(model);
}

}  // namespace

std::string_view name_of(Convergence convergence) {
  return convergence == Convergence::converged ? "converged" : "increments";
}

Result<NonlinearSolution> solve_neo_hookean(const Model& model, const Field& load, const Field& shift,
                                            const NonlinearOptions& options) {
  if (auto status = can_do(model); !status) return status.error();
  // the linear stiffness has the pattern and is the first Hessian
  auto K = assemble(model);
  if (!K) return K.error();
  auto factor = Factor::make(*K, held_axes(model));
  if (!factor) return factor.error();
  return Search(model, std::move(*K), std::move(*factor), load, shift, options).run();
}

Result<EnergyState> energy_state(const Model& model, const Field& u, bool project) {
  if (auto status = can_do(model); !status) return status.error();
  auto K = assemble(model);
  if (!K) return K.error();
  EnergyState state;
  state.hessian = std::move(*K);
  state.energy = Tissue(model).state(u, &state.force, &state.hessian, project);
  return state;
}

}  // namespace face
