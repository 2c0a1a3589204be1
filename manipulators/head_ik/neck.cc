#include "manipulators/head_ik/neck.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "manipulators/head_ik/swing_twist.h"

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Plain loops over arrays, which compilers turn into vector code, wider where the machine has it; the sums stay the
// same bits, because nothing is reordered or fused.
#define FOR_WIDE_MACHINES __attribute__((target_clones("default", "avx2")))

constexpr int most = Neck::most_levels;

// sines and cosines of the angles of all levels, by freedom, and the entries of the turn of each level
// L = Rx(flexion) Rz(lateral) Ry(axial)
struct Turns {
  alignas(32) double s[3][most], c[3][most];
  alignas(32) double L[3][3][most];
};

// Taylor series to x^15 and x^14 for |x| <= 0.6: the first neglected terms are 5e-19 and 1.4e-17, so the result is good
// to an ulp
constexpr double largest_series_angle = 0.6;
FOR_WIDE_MACHINES void series_sin_cos(const double* x, double* s, double* c, int n) {
  for (int i = 0; i < n; ++i) {
    const double t = x[i] * x[i];
    double p = -1.0 / 1307674368000.0, q = -1.0 / 87178291200.0;
    p = p * t + 1.0 / 6227020800.0;
    p = p * t - 1.0 / 39916800.0;
    p = p * t + 1.0 / 362880.0;
    p = p * t - 1.0 / 5040.0;
    p = p * t + 1.0 / 120.0;
    p = p * t - 1.0 / 6.0;
    q = q * t + 1.0 / 479001600.0;
    q = q * t - 1.0 / 3628800.0;
    q = q * t + 1.0 / 40320.0;
    q = q * t - 1.0 / 720.0;
    q = q * t + 1.0 / 24.0;
    q = q * t - 0.5;
    s[i] = x[i] + x[i] * t * p;
    c[i] = 1 + t * q;
  }
}

FOR_WIDE_MACHINES void level_turns(Turns* turns, int n) {
  const double *sf = turns->s[flexion], *sl = turns->s[lateral], *sa = turns->s[axial];
  const double *cf = turns->c[flexion], *cl = turns->c[lateral], *ca = turns->c[axial];
  auto& L = turns->L;
  for (int i = 0; i < n; ++i) {
    const double p = cf[i] * sl[i], q = sf[i] * sl[i];
    L[0][0][i] = cl[i] * ca[i];
    L[0][1][i] = -sl[i];
    L[0][2][i] = cl[i] * sa[i];
    L[1][0][i] = p * ca[i] + sf[i] * sa[i];
    L[1][1][i] = cf[i] * cl[i];
    L[1][2][i] = p * sa[i] - sf[i] * ca[i];
    L[2][0][i] = q * ca[i] - cf[i] * sa[i];
    L[2][1][i] = sf[i] * cl[i];
    L[2][2][i] = q * sa[i] + cf[i] * ca[i];
  }
}

void sin_cos(const double* x, double* s, double* c, int n) {
  double largest = 0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(x[i]));
  if (largest <= largest_series_angle) return series_sin_cos(x, s, c, n);
  for (int i = 0; i < n; ++i) s[i] = std::sin(x[i]), c[i] = std::cos(x[i]);
}

// sum of r_i x m_i over the columns: for M a rotation, 2 sin(angle) times the axis of M R^T
Vector3d moment(const Matrix3d& R, const Matrix3d& M) {
  return R.col(0).cross(M.col(0)) + R.col(1).cross(M.col(1)) + R.col(2).cross(M.col(2));
}

double angle_between(const Matrix3d& A, const Matrix3d& B) {
  return 2 * std::asin(std::min(1.0, (A - B).norm() / std::sqrt(8.0)));
}

}  // namespace

std::string_view name_of(Freedom freedom) {
  constexpr std::array<std::string_view, 3> names{"flexion", "lateral", "axial"};
  return names[freedom];
}

std::string_view name_of(Limit limit) {
  constexpr std::array<std::string_view, 4> names{"none", "tilt", "axial", "both"};
  return names[static_cast<int>(limit)];
}

// what one pass along the neck gives: R, the head's origin p, the angular velocities J (column k for a unit rate of
// total k) and their derivatives D[k][j] by total j
struct Neck::Frame {
  Matrix3d R, J;
  Vector3d p;
  std::array<std::array<Vector3d, 3>, 3> D;
};

Neck::Neck(std::vector<Level> levels, const Vector3d& base) : levels_(std::move(levels)), base_(base) {
  assert(!levels_.empty() && size() <= most_levels);
  lowest_.setZero();
  highest_.setZero();
  for (const Level& level : levels_) lowest_ += level.lower - level.rest, highest_ += level.upper - level.rest;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < size(); ++i) {
      const Level& level = levels_[i];
      share_[0][k][i] = lowest_[k] < 0 ? (level.lower[k] - level.rest[k]) / lowest_[k] : 0;
      share_[1][k][i] = highest_[k] > 0 ? (level.upper[k] - level.rest[k]) / highest_[k] : 0;
      rest_[k][i] = level.rest[k];
    }
  // a swing at level i acts on axes that the axial shares below have turned; on average by this part of the twist
  swing_lag_ = 0;
  double below = 0;
  for (int i = 0; i < size(); ++i) {
    swing_lag_ += below * (share_[1][flexion][i] + share_[1][lateral][i]) / 2;
    below += share_[1][axial][i];
  }
  rest_rotation_ = rotation(Vector3d::Zero());
  survey();
}

void Neck::spread(const Vector3d& total, double* angles) const {
  for (int i = 0; i < size(); ++i)
    for (int k = 0; k < 3; ++k)
      angles[3 * i + k] =
          std::clamp(rest_[k][i] + total[k] * share_[total[k] > 0][k][i], levels_[i].lower[k], levels_[i].upper[k]);
}

template <int order>
void Neck::evaluate(const Vector3d& total, Frame* frame) const {
  const int n = size();
  const std::array<const double*, 3> share{shares(total, 0), shares(total, 1), shares(total, 2)};
  Turns turns;
  for (int k = 0; k < 3; ++k) {
    double x[most];
    for (int i = 0; i < n; ++i) x[i] = rest_[k][i] + total[k] * share[k][i];
    sin_cos(x, turns.s[k], turns.c[k], n);
  }
  level_turns(&turns, n);

  // columns of four numbers, the last one idle, make whole vector registers
  using Column = Eigen::Vector4d;
  std::array<Column, 3> R{Column::UnitX(), Column::UnitY(), Column::UnitZ()};
  std::array<Column, 3> J{Column::Zero(), Column::Zero(), Column::Zero()};
  frame->p = base_;
  if constexpr (order > 1)
    for (auto& row : frame->D) row.fill(Vector3d::Zero());
  for (int i = 0; i < n; ++i) {
    const auto& L = turns.L;
    std::array<Column, 3> next;
    for (int j = 0; j < 3; ++j) next[j] = L[0][j][i] * R[0] + L[1][j][i] * R[1] + L[2][j][i] * R[2];
    if constexpr (order > 0) {
      // the axes of a level: X before it turns, Z after flexion, Y at last
      const std::array<Column, 3> w{share[flexion][i] * R[0],
                                    share[lateral][i] * (turns.c[flexion][i] * R[2] - turns.s[flexion][i] * R[1]),
                                    share[axial][i] * next[1]};
      for (int k = 0; k < 3; ++k) {
        if constexpr (order > 1)
          for (int j = 0; j < 3; ++j) frame->D[k][j] += J[j].head<3>().cross(w[k].head<3>());
        J[k] += w[k];
      }
    }
    R = next;
    if constexpr (order == 0) {
      const Vector3d& rise = levels_[i].rise;
      frame->p += (rise[0] * R[0] + rise[1] * R[1] + rise[2] * R[2]).head<3>();
    }
  }
  for (int k = 0; k < 3; ++k) frame->R.col(k) = R[k].head<3>(), frame->J.col(k) = J[k].head<3>();
}

const double* Neck::shares(const Vector3d& total, int freedom) const {
  return share_[total[freedom] > 0][freedom].data();
}

Matrix3d Neck::rotation(const Vector3d& total) const {
  Frame frame;
  evaluate<0>(total, &frame);
  return frame.R;
}

Vector3d Neck::origin_of_head(const Vector3d& total) const {
  Frame frame;
  evaluate<0>(total, &frame);
  return frame.p;
}

std::pair<Vector3d, Vector3d> Neck::groups(const Vector3d& total) const {
  double angles[3 * most_levels];
  spread(total, angles);
  const int lower_levels = size() - std::min(2, (size() + 1) / 2);
  std::pair<Vector3d, Vector3d> sums(Vector3d::Zero(), Vector3d::Zero());
  for (int i = 0; i < size(); ++i) (i < lower_levels ? sums.first : sums.second) += Vector3d(angles + 3 * i);
  return sums;
}

double Neck::tilt(const Vector3d& total) const {
  const double F = total[flexion] > 0 ? highest_[flexion] : -lowest_[flexion];
  const double L = total[lateral] > 0 ? highest_[lateral] : -lowest_[lateral];
  const double f = total[flexion] == 0 ? 0 : total[flexion] / F, l = total[lateral] == 0 ? 0 : total[lateral] / L;
  return std::sqrt(f * f + l * l);
}

double Neck::turn(const Vector3d& total) const {
  const double a = total[axial];
  return a == 0 ? 0 : a / (a > 0 ? highest_[axial] : lowest_[axial]);
}

Vector3d Neck::clamped(const Vector3d& total) const {
  const double out = std::max(1.0, tilt(total));
  return {total[flexion] / out, total[lateral] / out, std::clamp(total[axial], lowest_[axial], highest_[axial])};
}

Vector3d Neck::guess(const Matrix3d& R) const {
  const SwingTwist st = swing_twist(Eigen::Quaterniond(Matrix3d(R * rest_rotation_.transpose())));
  const double lag = swing_lag_ * st.twist, c = std::cos(lag), s = std::sin(lag);
  return {c * st.x - s * st.z, c * st.z + s * st.x, st.twist};
}

Neck::Solution Neck::solve(const Matrix3d& R, double roll_weight) const {
  Solution solution;
  solution.total = guess(R);
  // a target far outside is not worth a try
  const bool near = tilt(solution.total) < 1.5 && turn(solution.total) < 1.5;
  const Found found = near ? reach(R, &solution) : Found::nothing;
  if (found == Found::inside) return solution;

  const Matrix3d M = R * Vector3d(roll_weight, roll_weight, 1).asDiagonal();
  solution.total = clamped(solution.total);
  // from just outside the way to the boundary is plain; from afar there may be several
  if (found == Found::outside) {
    approach(M, &solution);
  } else {
    double least = INFINITY;
    for (const Vector3d& start : starts(M, solution.total)) {
      Solution down{start, Limit::none, 0, solution.iterations};
      approach(M, &down);
      const double value = shortfall(down.total, M);
      if (value < least) least = value, solution = down;
    }
  }
  solution.error = angle_between(rotation(solution.total), R);
  return solution;
}

Neck::Found Neck::reach(const Matrix3d& R, Solution* solution) const {
  Vector3d total = solution->total;
  Frame frame;
  for (int i = 1; i <= 10; ++i) {
    evaluate<1>(total, &frame);
    // e = angle * axis from sin(angle) * axis, by the series of arcsin: the guess is always near enough
    const Vector3d a = 0.5 * moment(frame.R, R);
    const double t = a.squaredNorm();
    if (t > 0.25) return Found::nothing;
    const Vector3d e = a * (1 + t * (1.0 / 6 + t * (3.0 / 40)));
    total += frame.J.inverse() * e;
    if (!(tilt(total) < 2 && turn(total) < 2)) return Found::nothing;
    solution->iterations = i;
    // the convergence is quadratic, with a factor below 1: what is left after this step is rounding
    if (t < 1e-16) {
      const bool inside = tilt(total) <= 1 + inside_slack && turn(total) <= 1 + inside_slack;
      solution->total = inside ? clamped(total) : total;
      solution->error = t;
      return inside ? Found::inside : Found::outside;
    }
  }
  return Found::nothing;
}

// -tr(M^T R) at a posture, with its first and second derivatives by the totals
struct Neck::Trace {
  double value;
  Vector3d g;
  Matrix3d H;
};

double Neck::shortfall(const Vector3d& total, const Matrix3d& M) const {
  Frame frame;
  evaluate<0>(total, &frame);
  return -frame.R.cwiseProduct(M).sum();
}

Neck::Trace Neck::trace(const Vector3d& total, const Matrix3d& M) const {
  Frame frame;
  evaluate<2>(total, &frame);
  const Vector3d a = moment(frame.R, M);
  Trace trace;
  trace.value = -frame.R.cwiseProduct(M).sum();
  trace.g = -frame.J.transpose() * a;
  // d a / d total_j = sum of (w_j x r_i) x m_i = sum of r_i (w_j . m_i) - w_j (r_i . m_i)
  const Matrix3d RMt = frame.R * M.transpose();
  const Matrix3d da = RMt * frame.J + frame.J * trace.value;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) trace.H(k, j) = -frame.D[k][j].dot(a) - frame.J.col(k).dot(da.col(j));
  trace.H = (0.5 * (trace.H + trace.H.transpose())).eval();
  return trace;
}

Vector3d Neck::on_ellipse(double angle, double axial_total) const {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * (c > 0 ? highest_[flexion] : -lowest_[flexion]), s * (s > 0 ? highest_[lateral] : -lowest_[lateral]),
          axial_total};
}

void Neck::survey() {
  for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0})
    for (int i = 0; i < most_lookouts / 5; ++i) {
      const double a = part * (part > 0 ? highest_[axial] : -lowest_[axial]);
      const Vector3d total = on_ellipse(i * 10 * M_PI / most_lookouts, a);
      lookouts_.push_back({total, rotation(total)});
    }
}

// A target on the far side has more than one nearest posture in sight: look around the boundary before going down, and
// go down twice when a second place, well apart from the best one, is nearly as good.
std::vector<Vector3d> Neck::starts(const Matrix3d& M, const Vector3d& first) const {
  constexpr double apart = 0.7;
  const double nearly = 0.15 * M.col(2).norm();
  std::array<double, most_lookouts> value;
  Vector3d best = first;
  double least = shortfall(first, M);
  for (std::size_t i = 0; i < lookouts_.size(); ++i) {
    value[i] = -lookouts_[i].R.cwiseProduct(M).sum();
    if (value[i] < least) least = value[i], best = lookouts_[i].total;
  }
  std::vector<Vector3d> found{best};
  double second = least + nearly;
  for (std::size_t i = 0; i < lookouts_.size(); ++i)
    if (value[i] < second && (lookouts_[i].total - best).norm() > apart) {
      second = value[i];
      found.resize(1);
      found.push_back(lookouts_[i].total);
    }
  return found;
}

// Newton's method for the least -tr(M^T R) over the set. Where the boundary is active the step goes along it: by the
// angle on the ellipse instead of flexion and lateral, without the axial total when that is at its end.
void Neck::approach(const Matrix3d& M, Solution* solution) const {
  Vector3d total = solution->total;
  const double scale = M.col(2).norm();
  bool at_tilt = false, at_turn = false;
  for (int iteration = 1; iteration <= 60; ++iteration) {
    solution->iterations += 1;
    const Trace here = trace(total, M);
    const double f = total[flexion], l = total[lateral];
    const double F = f > 0 ? highest_[flexion] : -lowest_[flexion], L = l > 0 ? highest_[lateral] : -lowest_[lateral];
    at_turn = turn(total) >= 1 - inside_slack && here.g[axial] * total[axial] < 0;
    at_tilt = tilt(total) >= 1 - inside_slack && here.g[flexion] * f / (F * F) + here.g[lateral] * l / (L * L) < 0;

    // the free directions as columns, and what is free of gradient and curvature
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> B(3, (at_tilt ? 1 : 2) + (at_turn ? 0 : 1));
    B.setZero();
    const double angle = std::atan2(l / L, f / F);
    if (at_tilt) {
      B.col(0) << -F * std::sin(angle), L * std::cos(angle), 0;
    } else {
      B(flexion, 0) = B(lateral, 1) = 1;
    }
    if (!at_turn) B(axial, B.cols() - 1) = 1;
    const auto g = (B.transpose() * here.g).eval();
    auto H = (B.transpose() * here.H * B).eval();
    if (at_tilt) H(0, 0) -= here.g[flexion] * f + here.g[lateral] * l;
    if (g.cwiseAbs().maxCoeff() < 1e-13 * scale) break;

    // a saddle or a hill is made a valley
    double shift = 0;
    auto llt = H.llt();
    while (llt.info() != Eigen::Success || llt.rcond() < 1e-10) {
      shift = shift == 0 ? 1e-3 * scale : 4 * shift;
      auto raised = H;
      raised.diagonal().array() += shift;
      llt.compute(raised);
    }
    auto step = (-llt.solve(g)).eval();
    step *= std::min(1.0, 0.5 / step.norm());

    const auto moved = [&](double part) {
      Vector3d to = at_tilt ? on_ellipse(angle + part * step[0], total[axial]) : total;
      if (!at_tilt) to.head<2>() += part * step.template head<2>();
      if (!at_turn) to[axial] += part * step[step.size() - 1];
      return clamped(to);
    };
    double part = 1;
    Vector3d next = moved(part);
    while (part > 1e-6 && shortfall(next, M) > here.value + 4e-16 * scale) next = moved(part /= 2);
    const double change = (next - total).norm();
    if (part > 1e-6) total = next;
    // the convergence is quadratic: what a whole step of this size leaves is rounding
    if (part <= 1e-6 || change < (part == 1 && shift == 0 ? 1e-7 : 1e-15)) break;
  }
  solution->total = total;
  solution->limit = static_cast<Limit>((at_tilt ? 1 : 0) + (at_turn ? 2 : 0));
}

// Mortensen, Vasavada & Merryweather 2018 (PLoS ONE 13(6) e0199912) and the OpenSim model that goes with it: the share
// of each level in its group's angle, the range of each group, and the joint centres. The shares of a group are brought
// to the sum 1 (as printed, flexion of the lower group sums to 1.001 and axial turning to 1.002).
namespace {

constexpr double degree = M_PI / 180;

struct Group {
  Vector3d lower, upper;
};
const Group lower_neck{Vector3d(-48, -33, -27) * degree, Vector3d(45, 33, 27) * degree};
const Group upper_neck{Vector3d(-24, -6, -38) * degree, Vector3d(16, 6, 38) * degree};

struct Row {
  const char* name;
  const Group* group;
  double share[3];     // flexion, lateral, axial
  double forward, up;  // from this centre to the next [m]
};
const Row rows[] = {
    {"c7_t1", &lower_neck, {.099, .078, .063}, .006416, .018035},
    {"c6_7", &lower_neck, {.187, .137, .188}, .000431, .013815},
    {"c5_6", &lower_neck, {.220, .157, .219}, .002760, .015600},
    {"c4_5", &lower_neck, {.220, .216, .219}, .002300, .018100},
    {"c3_4", &lower_neck, {.165, .216, .219}, .000540, .014080},
    {"c2_3", &lower_neck, {.110, .196, .094}, .001460, .032510},
    {"c1_2", &upper_neck, {.444, .500, .889}, .000900, .011400},
    {"c0_1", &upper_neck, {.556, .500, .111}, 0, 0},
};

Vector3d sum_of_shares(const Group* group) {
  Vector3d sum = Vector3d::Zero();
  for (const Row& row : rows)
    if (row.group == group) sum += Vector3d(row.share);
  return sum;
}

}  // namespace

Neck full_neck(double scale) {
  std::vector<Level> levels;
  for (const Row& row : rows) {
    const Vector3d share = Vector3d(row.share).cwiseQuotient(sum_of_shares(row.group));
    levels.push_back({row.name, row.group->lower.cwiseProduct(share), row.group->upper.cwiseProduct(share),
                      Vector3d::Zero(), scale * Vector3d(0, row.up, row.forward)});
  }
  return Neck(std::move(levels));
}

Neck reduced_neck(double scale) {
  // the mean centre of a group, weighted by the shares of flexion, as seen from the centre of C7-T1
  const auto centre = [&](const Group* group) {
    Vector3d here = Vector3d::Zero(), mean = Vector3d::Zero();
    for (const Row& row : rows) {
      if (row.group == group) mean += row.share[flexion] / sum_of_shares(group)[flexion] * here;
      here += scale * Vector3d(0, row.up, row.forward);
    }
    return std::pair(mean, here);
  };
  const auto [low, head_origin] = centre(&lower_neck);
  const Vector3d high = centre(&upper_neck).first;
  return Neck({{"lower", lower_neck.lower, lower_neck.upper, Vector3d::Zero(), high - low},
               {"upper", upper_neck.lower, upper_neck.upper, Vector3d::Zero(), head_origin - high}},
              low);
}

}  // namespace head
