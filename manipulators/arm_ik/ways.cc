#include "manipulators/arm_ik/ways.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using kinematics::Chain;
using kinematics::Pose;

constexpr double arrived = 1e-7;  // [m] and [rad]
constexpr int newton_steps = 30;
constexpr double at_limit = 1e-7;  // [rad]
constexpr double level = 1e-9;     // squared singular value that counts as none
constexpr double regular = 1e-9;   // squared [m], keeps singular postures solvable

std::vector<double> numbers(const VectorXd& q) { return {q.data(), q.data() + q.size()}; }

VectorXd error(const Chain& chain, const VectorXd& q, const Pose& pose) {
  const Pose at = kinematics::forward(chain, numbers(q));
  VectorXd e(6);
  e.head<3>() = pose.p - at.p;
  e.tail<3>() = kinematics::rotation_vector(pose.R * at.R.transpose());
  return e;
}

// least |J x - e|^2 + regular |x|^2 with low <= x <= high: the joints that pass a bound are held one by one, those that
// want back are let go
VectorXd bounded(const MatrixXd& J, const VectorXd& e, const VectorXd& low, const VectorXd& high) {
  const Eigen::Index n = J.cols();
  VectorXd x = VectorXd::Zero(n);
  std::vector<int> held(static_cast<size_t>(n), 0);
  for (int round = 0; round < 4 * n; ++round) {
    std::vector<Eigen::Index> free;
    VectorXd rest = e;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (held[i] == 0) {
        free.push_back(i);
      } else {
        x[i] = held[i] < 0 ? low[i] : high[i];
        rest -= J.col(i) * x[i];
      }
    }
    const MatrixXd A = J(Eigen::all, free);
    const MatrixXd AAt = A * A.transpose() + regular * MatrixXd::Identity(A.rows(), A.rows());
    const VectorXd y = A.transpose() * AAt.ldlt().solve(rest);
    double worst = 1e-14;
    Eigen::Index which = -1;
    for (size_t k = 0; k < free.size(); ++k) {
      const Eigen::Index i = free[k];
      x[i] = y[static_cast<Eigen::Index>(k)];
      const double past = std::max(low[i] - x[i], x[i] - high[i]);
      if (past > worst) worst = past, which = i;
    }
    if (which >= 0) {
      held[which] = x[which] < low[which] ? -1 : 1;
      continue;
    }
    const VectorXd slope = J.transpose() * (J * x - e) + regular * x;
    double pull = 1e-12;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double inwards = held[i] < 0 ? -slope[i] : held[i] > 0 ? slope[i] : 0;
      if (inwards > pull) pull = inwards, which = i;
    }
    if (which < 0) break;
    held[which] = 0;
  }
  return x.cwiseMax(low).cwiseMin(high);
}

double largest(const VectorXd& x) { return x.cwiseAbs().maxCoeff(); }

}  // namespace

bool Ways::inside(const Posture& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const kinematics::Joint& joint = chain_.joints[static_cast<size_t>(i)];
    if (!(q[i] >= joint.lower && q[i] <= joint.upper)) return false;
  }
  return true;
}

bool Ways::bring(Posture& q, const Pose& pose) const {
  VectorXd lower(q.size()), upper(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    lower[i] = chain_.joints[static_cast<size_t>(i)].lower;
    upper[i] = chain_.joints[static_cast<size_t>(i)].upper;
  }
  q = q.cwiseMax(lower).cwiseMin(upper);
  for (int step = 0; step < newton_steps; ++step) {
    const VectorXd e = error(chain_, q, pose);
    if (e.norm() < arrived) return true;
    const VectorXd x = bounded(kinematics::jacobian(chain_, numbers(q)), e, lower - q, upper - q);
    if (largest(x) < 1e-13) return false;
    q += x;
    q = q.cwiseMax(lower).cwiseMin(upper);
  }
  return false;
}

// unit directions in which q may move without moving the tool, both ways each; once with all joints and once without
// those that stand at a limit, so that the crowd also goes along the limits
std::vector<Ways::Posture> Ways::directions(const Posture& q) const {
  const MatrixXd J = kinematics::jacobian(chain_, numbers(q));
  std::vector<Posture> out;
  const auto add = [&](const std::vector<Eigen::Index>& free) {
    if (free.empty()) return;
    const MatrixXd A = J(Eigen::all, free);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(A.transpose() * A);
    for (Eigen::Index k = 0; k < solver.eigenvalues().size() && solver.eigenvalues()[k] < level; ++k) {
      VectorXd direction = VectorXd::Zero(q.size());
      for (size_t i = 0; i < free.size(); ++i)
        direction[free[i]] = solver.eigenvectors()(static_cast<Eigen::Index>(i), k);
      out.push_back(direction / largest(direction));
      out.push_back(-out.back());
    }
  };
  std::vector<Eigen::Index> all, off_limits;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const kinematics::Joint& joint = chain_.joints[static_cast<size_t>(i)];
    all.push_back(i);
    if (q[i] > joint.lower + at_limit && q[i] < joint.upper - at_limit) off_limits.push_back(i);
  }
  add(all);
  if (off_limits.size() < all.size()) add(off_limits);
  return out;
}

std::vector<Ways::Posture> Ways::connected(const std::vector<Posture>& from, const Pose& pose) const {
  std::vector<Posture> crowd;
  const auto is_new = [&](const Posture& q, double apart) {
    return std::all_of(crowd.begin(), crowd.end(), [&](const Posture& other) { return largest(other - q) > apart; });
  };
  for (const Posture& q : from) {
    if (is_new(q, 0.3 * options_.spacing)) crowd.push_back(q);
  }
  for (size_t k = 0; k < crowd.size() && static_cast<int>(crowd.size()) < options_.most; ++k) {
    const Posture at = crowd[k];
    for (const Posture& direction : directions(at)) {
      // shorter where a limit ends the set
      for (double length = options_.spacing; length > 0.02 * options_.spacing; length *= 0.5) {
        Posture next = at + length * direction;
        if (!bring(next, pose) || largest(next - at) > 2 * options_.spacing) continue;
        // the ends are worth more than the middle: a posture near others counts if it stands at a limit
        if (is_new(next, (length == options_.spacing ? 0.6 : 0.1) * options_.spacing)) crowd.push_back(next);
        break;
      }
    }
  }
  return crowd;
}

int Ways::goes_on(const Posture& q, const Course& course, int tick, int most) const {
  std::vector<Posture> crowd = {q};
  for (int gone = 0; gone < most; ++gone) {
    crowd = connected(crowd, course(tick + gone));
    std::vector<Posture> left;
    for (Posture posture : crowd) {
      bool follows = true;
      for (int s = 1; follows && s <= options_.substeps; ++s) {
        const Posture before = posture;
        const double time = tick + gone + static_cast<double>(s) / options_.substeps;
        follows = bring(posture, course(time)) && largest(posture - before) <= options_.leap;
      }
      if (follows && inside(posture)) left.push_back(posture);
    }
    if (left.empty()) return gone;
    crowd = std::move(left);
  }
  return most;
}

}  // namespace arm_ik
