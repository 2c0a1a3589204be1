// Time of the head's mathematics, with its baselines measured in the same run. Processor time of this process; the
// figures of one run compare with each other, those of two runs only when the machine was as busy.

#include <time.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "manipulators/head_ik/control.h"

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double sink = 0;

// median of 9 rounds over all inputs [ns per call]
template <class Input, class Function>
double time_of(const std::vector<Input>& inputs, Function function) {
  std::vector<double> rounds;
  for (int round = 0; round < 9; ++round) {
    const double start = processor_time();
    for (const Input& input : inputs) sink += function(input);
    rounds.push_back((processor_time() - start) / static_cast<double>(inputs.size()) * 1e9);
  }
  std::nth_element(rounds.begin(), rounds.begin() + 4, rounds.end());
  return rounds[4];
}

void print(const char* what, double ns, double baseline) {
  std::printf("%-66s %9.1f ns %8.2f\n", what, ns, ns / baseline);
}

Matrix3d plain_rotation(const head::Neck& neck, const Vector3d& total) {
  double angles[3 * head::Neck::most_levels];
  neck.spread(total, angles);
  Matrix3d R = Matrix3d::Identity();
  for (int j = 0; j < 3 * neck.size(); ++j) R = R * Eigen::AngleAxisd(angles[j], Vector3d::Unit(head::axis_of[j % 3]));
  return R;
}

// what a general solver does with this chain: 24 free joints, damped least squares, clamped
int damped_least_squares(const head::Neck& neck, const Matrix3d& wanted) {
  Eigen::Matrix<double, 24, 1> q = Eigen::Matrix<double, 24, 1>::Zero();
  for (int iteration = 1; iteration <= 100; ++iteration) {
    Matrix3d R = Matrix3d::Identity();
    Eigen::Matrix<double, 3, 24> J;
    for (int j = 0; j < 24; ++j) {
      J.col(j) = R.col(head::axis_of[j % 3]);
      R = R * Eigen::AngleAxisd(q[j], Vector3d::Unit(head::axis_of[j % 3]));
    }
    const Eigen::AngleAxisd error(wanted * R.transpose());
    if (error.angle() < 1e-10) return iteration;
    const Matrix3d A = J * J.transpose() + 1e-6 * Matrix3d::Identity();
    q += J.transpose() * (A.inverse() * (error.angle() * error.axis()));
    for (int j = 0; j < 24; ++j)
      q[j] = std::clamp(q[j], neck.levels()[j / 3].lower[j % 3], neck.levels()[j / 3].upper[j % 3]);
  }
  return 100;
}

}  // namespace

int main() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1);
  const head::Neck full = head::full_neck(), reduced = head::reduced_neck();

  std::vector<Matrix3d> anywhere, inside, inside_reduced, outside;
  std::vector<Vector3d> postures;
  while (anywhere.size() < 10'000) {
    const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    anywhere.push_back(q.normalized().toRotationMatrix());
    if (full.solve(anywhere.back()).limit != head::Limit::none) outside.push_back(anywhere.back());
  }
  outside.resize(2'000);
  while (inside.size() < 10'000) {
    const Vector3d total = full.clamped(1.3 * Vector3d(unit(random), unit(random), unit(random)));
    postures.push_back(total);
    inside.push_back(full.rotation(total));
    inside_reduced.push_back(reduced.rotation(total));
  }

  std::printf("%-66s %12s %8s\n", "ZYZ angles of a rotation matrix", "", "ratio");
  const auto zyz_time = [&](head::ZyzRule rule) {
    return time_of(anywhere, [&](const Matrix3d& R) {
      const head::Zyz angles = head::zyz(R, rule);
      return angles.alpha + angles.beta + angles.gamma;
    });
  };
  const double euler = time_of(anywhere, [](const Matrix3d& R) { return R.eulerAngles(2, 1, 2).sum(); });
  print("Eigen eulerAngles(2, 1, 2)", euler, euler);
  print("two_step (ours)", zyz_time(head::ZyzRule::two_step), euler);
  print("half_angle", zyz_time(head::ZyzRule::half_angle), euler);
  print("arc_cosine", zyz_time(head::ZyzRule::arc_cosine), euler);
  print("paper", zyz_time(head::ZyzRule::paper), euler);

  std::printf("\n%-66s\n", "forward kinematics, 24 joints");
  const double plain = time_of(postures, [&](const Vector3d& t) { return plain_rotation(full, t)(0, 0); });
  print("Eigen AngleAxis, one after the other", plain, plain);
  print("Neck::rotation, full", time_of(postures, [&](const Vector3d& t) { return full.rotation(t)(0, 0); }), plain);
  print("Neck::rotation, reduced", time_of(postures, [&](const Vector3d& t) { return reduced.rotation(t)(0, 0); }),
        plain);

  std::printf("\n%-66s\n", "orientation to joint angles, cold start");
  const std::vector<Matrix3d> few(inside.begin(), inside.begin() + 200);
  const double general = time_of(few, [&](const Matrix3d& R) { return damped_least_squares(full, R); });
  print("damped least squares, 24 free joints, clamped (Eigen)", general, general);
  const auto solve = [&](const head::Neck& neck, const Matrix3d& R) {
    double angles[3 * head::Neck::most_levels];
    neck.spread(neck.solve(R).total, angles);
    return angles[0];
  };
  print("Neck::solve and spread, full, reachable", time_of(inside, [&](const Matrix3d& R) { return solve(full, R); }),
        general);
  print("Neck::solve and spread, reduced, reachable",
        time_of(inside_reduced, [&](const Matrix3d& R) { return solve(reduced, R); }), general);
  print("Neck::solve and spread, full, nearest to one out of reach",
        time_of(outside, [&](const Matrix3d& R) { return solve(full, R); }), general);

  std::printf("\n%-66s\n", "one head, one tick of 1/60 s (16 or 17 steps of 1 ms)");
  std::vector<int> ticks(2'000);
  for (const bool moving : {false, true}) {
    head::Control control;
    head::Settings settings;
    settings.part = head::Part::full;
    int n = 0;
    const double time = time_of(ticks, [&](int) {
      const double t = ++n / 60.0, yaw = moving ? 0.6 * std::sin(2 * t) : 0.6;
      const head::Sight seen{head::Sight::point, 2 * head::direction({yaw, 0.2}), Vector3d::UnitZ()};
      return control.tick(full, settings, t, 1 / 60.0, seen, false).gaze_error;
    });
    print(moving ? "target moving" : "target standing", time, general);
  }
  return sink == 0.123 ? 1 : 0;
}
