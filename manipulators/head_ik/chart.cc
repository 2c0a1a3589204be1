#include "manipulators/head_ik/chart.h"

#include <time.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "manipulators/head_ik/control.h"

namespace head {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Exact = Eigen::Matrix<long double, 3, 3>;

constexpr double degree = M_PI / 180;
constexpr ZyzRule rules[] = {ZyzRule::two_step, ZyzRule::half_angle, ZyzRule::arc_cosine, ZyzRule::not_both,
                             ZyzRule::paper};

double processor_time() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

class Table {
 public:
  Table(const std::filesystem::path& file, const char* header) : file_(std::fopen(file.c_str(), "w")) {
    if (file_) std::fprintf(file_.get(), "%s\n", header);
  }
  template <class... Values>
  void row(const char* format, Values... values) {
    if (file_) std::fprintf(file_.get(), format, values...);
  }
  bool good() { return file_ && std::fflush(file_.get()) == 0 && !std::ferror(file_.get()); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

// the paper's matrix in extended precision
Exact exact_rotation(long double alpha, long double beta, long double gamma) {
  const auto turn = [](int axis, long double angle) {
    Exact R = Exact::Identity();
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    R(u, u) = R(v, v) = std::cos(angle);
    R(v, u) = std::sin(angle);
    R(u, v) = -R(v, u);
    return R;
  };
  return turn(2, alpha) * turn(1, beta) * turn(2, gamma);
}

double rotation_error(const Exact& R, const Zyz& angles) {
  const Exact D = exact_rotation(angles.alpha, angles.beta, angles.gamma) - R;
  const long double half_sine = std::fmin(1.0L, D.norm() / std::sqrt(8.0L));
  return static_cast<double>(2 * std::asin(half_sine));
}

// orientations at one distance from a pole, a sixth of them with a gamma or alpha of exactly 0, as poses that people
// write down often are
std::vector<Exact> orientations(const char* pole, double distance, double noise, int count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), unit(-1, 1);
  std::vector<Exact> found;
  for (int i = 0; i < count; ++i) {
    const long double beta = pole[0] == '0' ? static_cast<long double>(distance) : std::acos(-1.0L) - distance;
    const double alpha = angle(random), gamma = i % 6 == 0 ? 0 : angle(random);
    found.push_back(exact_rotation(alpha, beta, gamma));
    if (noise > 0) found.back() += noise * Exact::NullaryExpr([&] { return static_cast<long double>(unit(random)); });
  }
  return found;
}

bool chart_zyz(const std::filesystem::path& folder) {
  Table errors(folder / "zyz_error.csv", "method,noise,pole,distance_rad,largest_error_rad,median_error_rad");
  Table times(folder / "zyz_time.csv", "method,noise,pole,distance_rad,time_ns");
  for (const double noise : {0.0, 1e-12})
    for (const char* pole : {"0", "pi"})
      for (double exponent = -16; exponent <= 0.1; exponent += 0.5) {
        const double distance = std::min(std::pow(10, exponent), M_PI / 2);
        const std::vector<Exact> exact = orientations(pole, distance, noise, 600);
        std::vector<Matrix3d> given;
        for (const Exact& R : exact) given.push_back(R.cast<double>());
        for (const ZyzRule rule : rules) {
          std::vector<double> error, time;
          for (std::size_t i = 0; i < exact.size(); ++i) error.push_back(rotation_error(exact[i], zyz(given[i], rule)));
          double sum = 0;
          for (int round = 0; round < 9; ++round) {
            const double start = processor_time();
            for (const Matrix3d& R : given) sum += zyz(R, rule).gamma;
            time.push_back((processor_time() - start) / static_cast<double>(given.size()) * 1e9);
          }
          const std::string name(name_of(rule));
          errors.row("%s,%g,%s,%.6g,%.6g,%.6g\n", name.c_str(), noise, pole, distance,
                     *std::max_element(error.begin(), error.end()), median(error));
          // the sum is used, so the loop stays
          times.row("%s,%g,%s,%.6g,%.1f\n", name.c_str(), noise, pole, distance,
                    median(time) + (sum == 0.5 ? 1e-9 : 0));
        }
      }
  return errors.good() && times.good();
}

// a gaze that goes by the pole at 1e-3 rad in steps of 1e-4: what jumps in ZYZ and what does not in the neck
bool chart_pass(const std::filesystem::path& folder) {
  Table table(folder / "zyz_pass.csv",
              "path_rad,alpha_rad,beta_rad,gamma_rad,paper_alpha_step_rad,alpha_step_rad,joint_step_rad");
  const Neck neck = full_neck();
  double before[24] = {}, now[24];
  Zyz last, last_paper;
  for (int i = -200; i <= 200; ++i) {
    const double at = 1e-4 * i;
    const Matrix3d R = donders(gaze(Vector3d(at, 1e-3, 1)), 1);
    const Zyz angles = zyz(R), paper = zyz(R, ZyzRule::paper);
    neck.spread(neck.solve(R).total, now);
    double step = 0;
    for (int j = 0; j < 24; ++j) step = std::max(step, std::abs(now[j] - before[j]));
    if (i > -200)
      table.row("%.4g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", at, angles.alpha, angles.beta, angles.gamma,
                std::abs(std::remainder(paper.alpha - last_paper.alpha, 2 * M_PI)),
                std::abs(std::remainder(angles.alpha - last.alpha, 2 * M_PI)), step);
    std::copy(now, now + 24, before);
    last = angles;
    last_paper = paper;
  }
  return table.good();
}

// the error of the gaze over all directions, for the paper's rule (printed extraction, angles clamped one by one) and
// ours
bool chart_reach(const std::filesystem::path& folder) {
  Table table(folder / "reach.csv", "yaw_deg,pitch_deg,error_deg,paper_error_deg");
  const Neck neck = full_neck();
  for (int yaw = -120; yaw <= 120; yaw += 2)
    for (int pitch = -88; pitch <= 88; pitch += 2) {
      const Matrix3d R = donders({yaw * degree, pitch * degree}, 1);
      const auto error = [&](const Matrix3d& wanted) {
        return angle_between(neck.rotation(neck.solve(wanted).total).col(2), R.col(2)) / degree;
      };
      table.row("%d,%d,%.3f,%.3f\n", yaw, pitch, error(R), error(paper_orientation(R)));
    }
  return table.good();
}

bool chart_share(const std::filesystem::path& folder) {
  Table table(folder / "share.csv", "gaze_deg,head_deg,eye_deg,head_pitch_deg");
  const Neck neck = full_neck();
  for (int gaze_angle = 0; gaze_angle <= 120; gaze_angle += 1) {
    const double head = std::min(head_part({gaze_angle * degree, 0}, {}).yaw, neck.highest()[axial]) / degree;
    const double nod = head_part({0, std::min(gaze_angle, 90) * degree}, {}).pitch / degree;
    table.row("%d,%.4f,%.4f,%.4f\n", gaze_angle, head, gaze_angle - head, nod);
  }
  return table.good();
}

// gaze shifts from straight ahead, all of the gaze by the head, so that amplitude is the head's
bool chart_shifts(const std::filesystem::path& folder) {
  Table course(folder / "shift.csv", "amplitude_deg,t_s,head_deg,speed_deg_s");
  Table speed(folder / "speed.csv", "amplitude_deg,peak_speed_deg_s,start_s,duration_s");
  const Neck neck = full_neck();
  Settings settings;
  settings.part = Part::full;
  for (int amplitude = 5; amplitude <= 65; amplitude += 5) {
    Control control;
    const Sight seen{Sight::point, Vector3d(0, 0.17, 0.1) + 1e3 * direction({amplitude * degree, 0}),
                     Vector3d::UnitZ()};
    double before = 0, peak = 0, start = -1, end = 0;
    for (int n = 1; n <= 1200; ++n) {
      const double t = n * 1e-3;
      const double head = control.tick(neck, settings, t, 1e-3, seen, false).posture[axial] / degree;
      const double now = (head - before) * 1e3;
      peak = std::max(peak, now);
      // onset and end as experimenters take them: 2 percent and 98 percent of the way
      if (start < 0 && head > 0.02 * amplitude) start = t;
      if (head < 0.98 * amplitude) end = t;
      if (amplitude % 15 == 5 && n % 5 == 0) course.row("%d,%.3f,%.4f,%.3f\n", amplitude, t, head, now);
      before = head;
    }
    if (amplitude % 15 == 5) course.row("\n\n");
    speed.row("%d,%.2f,%.4f,%.4f\n", amplitude, peak, start, end - start);
  }
  return course.good() && speed.good();
}

// error and time of the solver, by how far out the wanted posture is: 1 is the limit
bool chart_solver(const std::filesystem::path& folder) {
  Table table(folder / "solve.csv", "neck,out,largest_error_rad,median_steps,time_ns,limited");
  for (const bool full : {true, false}) {
    const Neck neck = full ? full_neck() : reduced_neck();
    std::mt19937_64 random(12);
    std::normal_distribution<double> normal;
    for (double out = 0.05; out <= 2.01; out += 0.05) {
      std::vector<Matrix3d> wanted;
      for (int i = 0; i < 400; ++i) {
        // a direction in the space of totals, brought to this distance
        Vector3d total(normal(random) * neck.highest()[0], normal(random) * neck.highest()[1],
                       normal(random) * neck.highest()[2]);
        total *= out / std::max(neck.tilt(total), neck.turn(total));
        wanted.push_back(neck.rotation(total));
      }
      std::vector<double> steps, time;
      double largest = 0, sum = 0;
      int limited = 0;
      for (const Matrix3d& R : wanted) {
        const Neck::Solution solution = neck.solve(R);
        steps.push_back(solution.iterations);
        limited += solution.limit != Limit::none;
        const double error = Eigen::AngleAxisd(Matrix3d(neck.rotation(solution.total).transpose() * R)).angle();
        if (solution.limit == Limit::none) largest = std::max(largest, error);
      }
      for (int round = 0; round < 5; ++round) {
        const double start = processor_time();
        for (const Matrix3d& R : wanted) sum += neck.solve(R).total[0];
        time.push_back((processor_time() - start) / static_cast<double>(wanted.size()) * 1e9);
      }
      table.row("%s,%.2f,%.6g,%.0f,%.1f,%d\n", full ? "full" : "reduced", out, largest, median(steps),
                median(time) + (sum == 0.5 ? 1e-9 : 0), limited);
    }
    table.row("\n\n");
  }
  return table.good();
}

}  // namespace

int chart_command(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const auto chart : {chart_zyz, chart_pass, chart_reach, chart_share, chart_shifts, chart_solver})
    if (error || !chart(folder)) {
      std::fprintf(stderr, "%s:0:0: error io cannot be written\n", folder.c_str());
      return 1;
    }
  return 0;
}

}  // namespace head
