#include "manipulators/arm_ik/coupled.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "manipulators/arm_ik/limb.h"

namespace arm_ik {

namespace {

using Inputs = Eigen::Matrix<double, 5, 1>;  // plane, elevation, axial, elbow, forearm
using Rows = Eigen::Matrix<double, 3, 5>;
using kinematics::Pose;

constexpr int shoulder = 6, elbow = 9, forearm = 10;
constexpr int most_steps = 30;
constexpr double difference = 1e-7;  // of the girdle's motion [rad]
// weights of the wishes that come after the place [1 / rad^2]; only their ratio matters
constexpr double orientation_weight = 1, rest_weight = 1e-3, limit_weight = 1e7;
constexpr double softness = 1e-9;  // of the place [m^2 rad^2]: what a step may leave where the arm is stretched
constexpr double first_damping = 1e-2;
constexpr double longest_step = 0.5;
constexpr double settled = 1e-6;  // a smaller step [rad] is the end

/// Everything that follows from the inputs.
struct Posture {
  Inputs u;
  double q[HumanArm::joints];
  std::vector<Pose> frames;
  Eigen::Vector3d center;
};

class Coupled {
 public:
  Coupled(const HumanArm& arm) : arm_(arm), chain_(arm.chain()) {
    const std::vector<double> zero(HumanArm::joints, 0.0);
    const Pose X9 = kinematics::frames(chain_, zero)[9];
    offset_ = (X9.R.transpose() * arm.thorax()).transpose();
  }

  // `near`: joint values that decide between the two branches of the shoulder
  Posture at(const Inputs& u, std::span<const double> near) const {
    using namespace kinematics;
    Posture out;
    out.u = u;
    const GirdleAngles girdle = arm_.girdle_of(u[0], u[1]);
    std::copy(near.begin(), near.begin() + HumanArm::joints, out.q);
    std::copy(girdle.begin(), girdle.end(), out.q);
    const Eigen::Matrix3d humerus = arm_.thorax() * rotation_y(u[0]) * rotation_z(u[1]) * rotation_y(u[2]) * offset_;
    const std::vector<Pose> X = frames(chain_, out.q);
    set_shoulder(X[shoulder].R.transpose() * humerus * rotation_x(-chain_.joints[8].alpha), near, out.q);
    out.q[elbow] = u[3];
    out.q[forearm] = u[4];
    out.frames = frames(chain_, out.q);
    out.center = out.frames[7].p;
    return out;
  }

  Inputs inputs_of(std::span<const double> q) const {
    const Eigen::Matrix3d H = arm_.humerus(q);
    const auto [plane, elevation] = HumanArm::direction(H, 0);
    const Eigen::Matrix3d rest = kinematics::rotation_z(-elevation) * kinematics::rotation_y(-plane) * H;
    return (Inputs() << plane, elevation, std::atan2(rest(0, 2), rest(0, 0)), q[elbow], q[forearm]).finished();
  }

 private:
  // H = Rz(a) Rx(90) Rz(b) Rx(90) Rz(c): two branches, the one nearer to where the joints were
  void set_shoulder(const Eigen::Matrix3d& H, std::span<const double> near, double* q) const {
    const double sb = std::hypot(H(0, 2), H(1, 2));
    double best = HUGE_VAL;
    for (const double side : {-1.0, 1.0}) {
      // where b is 0 or pi only a + c is known: a stays
      const double a =
          sb > 1e-12 ? std::atan2(side * H(1, 2), side * H(0, 2)) : near[shoulder] + chain_.joints[shoulder].offset;
      const double b = std::atan2(side * sb, -H(2, 2));
      const double ca = std::cos(a), sa = std::sin(a);
      const double c = std::atan2(sa * H(0, 0) - ca * H(1, 0), sa * H(0, 1) - ca * H(1, 1));
      const double raw[3] = {a, b, c};
      double value[3], away = 0;
      for (int i = 0; i < 3; ++i) {
        const kinematics::Joint& joint = chain_.joints[shoulder + i];
        const double middle = 0.5 * (joint.lower + joint.upper);
        value[i] = middle + std::remainder(raw[i] - joint.offset - middle, 2 * M_PI);
        away += std::abs(value[i] - near[shoulder + i]);
      }
      if (away >= best) continue;
      best = away;
      std::copy_n(value, 3, q + shoulder);
    }
  }

  const HumanArm& arm_;
  const kinematics::Chain& chain_;
  Eigen::Matrix3d offset_;
};

/// How place, orientation and shoulder joints move with the inputs.
struct Slopes {
  Rows place, turn, shoulder;
};

Slopes slopes_at(const Coupled& model, const HumanArm& arm, const Posture& at) {
  Slopes out;
  const Eigen::Vector3d tip = at.frames.back().p;
  const Eigen::Matrix3d R = arm.thorax() * kinematics::rotation_y(at.u[0]);
  const Eigen::Vector3d axis[5] = {arm.thorax().col(1), R.col(2), (R * kinematics::rotation_z(at.u[1])).col(1),
                                   at.frames[elbow].R.col(2), at.frames[forearm].R.col(2)};
  const Eigen::Vector3d through[5] = {at.center, at.center, at.center, at.frames[elbow].p, at.frames[forearm].p};
  out.shoulder.setZero();
  for (int i = 0; i < 5; ++i) {
    out.place.col(i) = axis[i].cross(tip - through[i]);
    out.turn.col(i) = axis[i];
    if (i > 2) continue;
    // what the girdle adds, and what is left for the shoulder's joints
    Inputs beside = at.u;
    beside[i] += difference;
    const Posture moved = model.at(beside, at.q);
    out.place.col(i) += (moved.center - at.center) / difference;
    for (int k = 0; k < 3; ++k) out.shoulder(k, i) = (moved.q[shoulder + k] - at.q[shoulder + k]) / difference;
  }
  return out;
}

}  // namespace

Solution solve_coupled(const HumanArm& arm, const Goal& goal, const SolveOptions& options, std::span<double> q) {
  const kinematics::Chain& chain = arm.chain();
  const Coupled model(arm);
  const Pose wanted = arm.mirrored(goal.target());
  std::vector<double> rest_posture;
  for (const kinematics::Joint& joint : chain.joints) rest_posture.push_back(joint.rest);
  const Inputs rest = model.inputs_of(rest_posture);

  // the closed form is near: exact where limits leave its swivel alone
  Solution out = solve_limb(arm, goal, options, true, q);
  out.method = Method::rhythm;
  out.starts = 2;
  const int closed_form = out.iterations;
  out.iterations = 0;
  Posture at = model.at(model.inputs_of(q), q);
  double least = HUGE_VAL, last = HUGE_VAL, damping = first_damping;
  const int budget = std::clamp(static_cast<int>(options.budget / 6e-6), 1, most_steps);
  for (; out.iterations <= budget; ++out.iterations) {
    // the best posture that keeps the limits is the answer
    double kept[HumanArm::joints];
    for (int i = 0; i < HumanArm::joints; ++i)
      kept[i] = std::clamp(at.q[i], chain.joints[i].lower, chain.joints[i].upper);
    const Pose held = kinematics::forward(chain, kept);
    const double place = (wanted.p - held.p).norm();
    const double turn = goal.pose ? kinematics::rotation_distance(wanted.R, held.R) : 0;
    // place first, orientation second
    const double merit = place > options.position_tolerance ? 10 + place : turn;
    if (merit < least) {
      least = merit;
      out.position_error = place;
      out.rotation_error = turn;
      std::copy_n(kept, HumanArm::joints, q.begin());
    }
    if (out.iterations == budget || (!goal.pose && place <= options.position_tolerance)) break;
    // a step that helps is trusted more, one that does not less
    damping = std::clamp(merit < last ? damping * 0.2 : damping * 10, 1e-9, 10.0);
    last = merit;

    const Slopes slopes = slopes_at(model, arm, at);
    const Eigen::Vector3d e = wanted.p - at.frames.back().p;
    const Eigen::Vector3d turn_left =
        goal.pose ? kinematics::rotation_vector(wanted.R * at.frames.back().R.transpose()) : Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 5, 5> H = Eigen::Matrix<double, 5, 5>::Identity() * (rest_weight + damping);
    Inputs g = rest_weight * (rest - at.u);
    if (goal.pose) {
      H += orientation_weight * slopes.turn.transpose() * slopes.turn;
      g += orientation_weight * slopes.turn.transpose() * turn_left;
    }
    // active rows: a limit that the step would pass is met instead
    std::vector<bool> held_row(5, false);
    Inputs du;
    for (int round = 0; round < 6; ++round) {
      const Eigen::LLT<Eigen::Matrix<double, 5, 5>> factor(H);
      const Inputs free = factor.solve(g);
      const Eigen::Matrix<double, 5, 3> back = factor.solve(slopes.place.transpose());
      const Eigen::Matrix3d S = slopes.place * back + softness * Eigen::Matrix3d::Identity();
      du = free + back * S.llt().solve(e - slopes.place * free);
      bool added = false;
      for (int i = 0; i < 5; ++i) {
        const kinematics::Joint& joint = chain.joints[shoulder + i];
        Inputs row = Inputs::Zero();
        if (i < 3) {
          row = slopes.shoulder.row(i).transpose();
        } else {
          row[i] = 1;
        }
        const double next = at.q[shoulder + i] + row.dot(du);
        if (held_row[i] || (next <= joint.upper + 1e-12 && next >= joint.lower - 1e-12)) continue;
        held_row[i] = added = true;
        const double gap = (next > joint.upper ? joint.upper : joint.lower) - at.q[shoulder + i];
        H += limit_weight * row * row.transpose();
        g += limit_weight * gap * row;
      }
      if (!added) break;
    }
    const double longest = du.cwiseAbs().maxCoeff();
    if (!std::isfinite(longest)) break;
    if (longest > longest_step) du *= longest_step / longest;
    if (longest < settled) break;
    // the regression knows planes of one turn and raised arms
    Inputs next = at.u + du;
    next[0] = std::remainder(next[0], 2 * M_PI);
    next[1] = std::clamp(next[1], 0.0, M_PI);
    at = model.at(next, at.q);
  }
  out.iterations += closed_form;
  const bool reached =
      out.position_error <= options.position_tolerance && out.rotation_error <= options.rotation_tolerance;
  out.status = reached ? Status::reached : Status::limited;
  return out;
}

}  // namespace arm_ik
