#include "manipulators/arm_ik/chart.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "manipulators/arm_ik/contestants.h"
#include "manipulators/arm_ik/cpu_clock.h"
#include "manipulators/arm_ik/random.h"
#include "manipulators/kinematics/arm11.h"

namespace arm_ik {

namespace {

using kinematics::Chain;
using kinematics::Pose;

constexpr double tolerances[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12};
constexpr int own_targets = 2000, slow_targets = 200, peer_targets = 24;
constexpr double peer_budget = 5e-3, peer_tick_budget = 1e-3;   // [s]
constexpr double shoulder_height = -0.04, shoulder_side = 0.2;  // of the thorax frame [m]

/// One file of comma separated rows.
class Sheet {
 public:
  Sheet(const std::string& folder, const std::string& name, const std::string& header) : out_(folder + "/" + name) {
    out_.precision(6);
    out_ << header << "\n";
  }
  template <class... Cells>
  void row(const Cells&... cells) {
    bool first = true;
    ((out_ << (first ? "" : ","), first = false, out_ << cells), ...);
    out_ << "\n";
  }
  bool good() {
    out_.flush();
    return static_cast<bool>(out_);
  }

 private:
  std::ofstream out_;
};

void say(const std::string& what) {
  if (isatty(STDERR_FILENO)) std::cerr << "arm_ik: measuring " << what << "\n";
}

bool work_precision(const std::string& folder, const Chain& chain) {
  Sheet sheet(folder, "work_precision.csv",
              "chain,set,solver,tolerance_m,targets,failed,median_us,p99_us,median_position_m,median_rotation_rad");
  Engine engine(chain);
  engine.prepare(Method::reach);
  const auto peers = peers_for(chain);
  for (const ProblemSet set : problem_sets) {
    say("set " + std::string(name_of(set)));
    const auto list = problems(chain, set, own_targets, 7);
    const auto first = [&](int count) { return std::vector<Problem>(list.begin(), list.begin() + count); };
    const auto add = [&](const Contestant& who, int count, double tolerance, int passes) {
      const Score s = measure(chain, first(count), who, tolerance, 10 * tolerance, passes);
      sheet.row(chain.name, name_of(set), who.name, tolerance, s.targets, s.failed, s.median, s.p99, s.median_position,
                s.median_rotation);
    };
    for (const double tolerance : tolerances) {
      for (const Method method : {Method::automatic, Method::full, Method::reach, Method::polish}) {
        add(contestant(engine, method), own_targets, tolerance, 2);
      }
      add(contestant(engine, Method::clamped), slow_targets, tolerance, 1);
      // nobody else stops at a target out of reach: one tolerance shows it
      if (set == ProblemSet::unreachable && tolerance != 1e-5) continue;
      for (const auto& peer : peers) add(contestant(*peer, peer_budget), peer_targets, tolerance, 1);
    }
  }
  return sheet.good();
}

bool places(const std::string& folder, const Chain& chain) {
  say("places");
  Sheet sheet(folder, "place.csv", "solver,targets,reached,within_1cm,within_3cm,mean_miss_m,median_us,p99_us");
  Engine engine(chain);
  engine.prepare(Method::reach);
  const auto list = problems(chain, ProblemSet::random, own_targets, 11);
  for (const Method method :
       {Method::limb, Method::rhythm, Method::full, Method::reach, Method::clamped, Method::automatic}) {
    int reached = 0, near = 0, close = 0;
    double miss = 0;
    std::vector<double> times;
    for (const Problem& problem : list) {
      std::vector<double> q;
      for (const kinematics::Joint& joint : chain.joints) q.push_back(joint.rest);
      const double before = cpu_seconds();
      const Solution s = engine.solve(method, Goal(problem.target, false), {}, q);
      times.push_back(1e6 * (cpu_seconds() - before));
      reached += s.status == Status::reached;
      near += s.position_error < 0.01;
      close += s.position_error < 0.03;
      miss += s.position_error / own_targets;
    }
    std::sort(times.begin(), times.end());
    const auto share = [&](int count) { return static_cast<double>(count) / own_targets; };
    sheet.row(name_of(method), own_targets, share(reached), share(near), share(close), miss, times[times.size() / 2],
              times[times.size() * 99 / 100]);
  }
  return sheet.good();
}

bool tracking(const std::string& folder, const Chain& chain) {
  say("tracking");
  Sheet sheet(folder, "tracking.csv", "path,solver,ticks,failed,jumps,largest_step_rad,drift_rad,median_us,p99_us");
  const auto add = [&](const std::string& path, const std::string& name, const TrackScore& s) {
    sheet.row(path, name, s.ticks, s.failed, s.jumps, s.largest_step, s.drift, s.median, s.p99);
  };
  const Packed packed(chain);
  const auto ours = [&](double largest) { return follower(chain, packed, 2 * largest / 0.01); };
  add("courses", "tracker", track(chain, 10, 100, ours));
  add("out_and_back", "tracker", out_and_back(chain, 10, 100, follower(chain, packed, 10)));
  for (const auto& peer : peers_for(chain)) {
    add("courses", peer->name(), track(chain, 1, 100, [&](double) { return follower(*peer, peer_tick_budget); }));
    add("out_and_back", peer->name(), out_and_back(chain, 1, 100, follower(*peer, peer_tick_budget)));
  }
  return sheet.good();
}

bool journey(const std::string& folder, const Chain& chain) {
  say("a journey out of reach");
  Sheet sheet(folder, "out_and_back.csv", "solver,t_s,target_out_m,position_error_m,largest_step_rad,from_home_rad");
  const Packed packed(chain);
  const std::vector<double> home_posture = Course(chain, lap, 103).posture(0);
  const Pose home = kinematics::forward(chain, home_posture);
  const auto go = [&](const Follower& who) {
    std::vector<double> q = home_posture;
    for (int settle = 0; settle < 2 * lap; ++settle) who.tick(home, q);
    const std::vector<double> start = q;
    for (int t = 1; t <= lap; ++t) {
      const double out = 0.4 * (1 - std::cos(2 * M_PI * t / lap));
      Pose target = home;
      target.p += (home.p - chain.base.p).normalized() * out;
      const std::vector<double> before = q;
      who.tick(target, q);
      double step = 0, away = 0;
      for (int i = 0; i < chain.size(); ++i) {
        step = std::max(step, std::abs(q[i] - before[i]));
        away = std::max(away, std::abs(q[i] - start[i]));
      }
      sheet.row(who.name, 0.01 * t, out, (kinematics::forward(chain, q).p - target.p).norm(), step, away);
    }
  };
  go(follower(chain, packed, 10));
  for (const auto& peer : peers_for(chain)) go(follower(*peer, peer_tick_budget));
  return sheet.good();
}

bool atlas(const std::string& folder, const Chain& chain) {
  say("the atlas");
  Sheet sheet(folder, "atlas.csv", "plane,across_m,up_m,limb_m,rhythm_m,all_m");
  Engine engine(chain);
  engine.prepare(Method::reach);
  SolveOptions options;
  options.position_tolerance = 1e-4;
  options.budget = 2e-4;
  constexpr int cells = 56;
  for (const std::string plane : {"frontal", "sagittal"}) {
    for (int row = 0; row <= cells; ++row) {
      for (int column = 0; column <= cells; ++column) {
        const double across = -0.9 + 1.8 * column / cells, up = -0.9 + 1.8 * row / cells;
        Pose target;
        // x right, y up, z back; the planes cross at the hanging arm's shoulder; across is outwards or forwards
        target.p = plane == "frontal" ? Eigen::Vector3d(shoulder_side + across, shoulder_height + up, -0.15)
                                      : Eigen::Vector3d(shoulder_side, shoulder_height + up, -across);
        double error[3];
        int at = 0;
        for (const Method method : {Method::limb, Method::rhythm, Method::reach}) {
          std::vector<double> q;
          for (const kinematics::Joint& joint : chain.joints) q.push_back(joint.rest);
          error[at++] = engine.solve(method, Goal(target, false), options, q).position_error;
        }
        sheet.row(plane, across, up, error[0], error[1], error[2]);
      }
    }
  }
  return sheet.good();
}

}  // namespace

int chart(const std::string& folder) {
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  const Chain chain = kinematics::arm11();
  if (!fault && work_precision(folder, chain) && places(folder, chain) && tracking(folder, chain) &&
      journey(folder, chain) && atlas(folder, chain)) {
    return 0;
  }
  std::cerr << folder << ": error io cannot be written\n";
  return 1;
}

}  // namespace arm_ik
