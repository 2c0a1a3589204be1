// The arm's inverse kinematics against its targets and against other libraries, in one run; with the word `ways` why
// followers lose targets on closed courses.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "manipulators/arm_ik/contestants.h"
#include "manipulators/arm_ik/limb.h"
#include "manipulators/arm_ik/random.h"
#include "manipulators/arm_ik/ways.h"
#include "manipulators/kinematics/arm11.h"
#include "manipulators/kinematics/chain_file.h"

namespace {

using namespace arm_ik;
using kinematics::Chain;
using kinematics::Pose;

constexpr double tick = 0.01;         // [s]
constexpr double peer_budget = 5e-3;  // [s]

void print(const std::string& set, const std::string& name, const Score& s) {
  std::printf("%-22s %-13s %8d %7d %10.2f %10.2f %11.1e %9.1e\n", set.c_str(), name.c_str(), s.targets, s.failed,
              s.median, s.p99, s.median_position, s.median_rotation);
}

void print(const std::string& set, const std::string& name, const TrackScore& s) {
  std::printf("%-22s %-13s %8d %7d %6d %10.3f %10.1e %9.2f %9.2f\n", set.c_str(), name.c_str(), s.ticks, s.failed,
              s.jumps, s.largest_step, s.drift, s.median, s.p99);
}

// one chain, all sets; peers on the first targets of the same list
void sets_of(const Chain& chain, int count, int peer_count) {
  Engine engine(chain);
  engine.prepare(Method::reach);
  const auto peers = peer_count > 0 ? peers_for(chain) : std::vector<std::unique_ptr<Peer>>();
  const auto row = [&](ProblemSet set, Method method, double position, const std::string& label, int passes) {
    const auto list = problems(chain, set, count, 7);
    print(chain.name + " " + label, name_of(method).data(),
          measure(chain, list, contestant(engine, method), position, 10 * position, passes));
    const std::vector<Problem> few(list.begin(), list.begin() + std::min<std::ptrdiff_t>(peer_count, count));
    for (const auto& peer : peers)
      print("", peer->name(), measure(chain, few, contestant(*peer, peer_budget), position, 10 * position, 1));
  };
  row(ProblemSet::random, Method::reach, 1e-5, "random", 2);
  row(ProblemSet::warm, Method::automatic, 1e-5, "warm", 3);
  row(ProblemSet::near_limit, Method::reach, 1e-5, "near limits", 2);
  row(ProblemSet::singular, Method::reach, 1e-5, "singular", 2);
  row(ProblemSet::random, Method::reach, 1e-12, "random to 1e-12", 2);
  row(ProblemSet::unreachable, Method::reach, 1e-5, "out of reach", 2);
}

void a_million(const Chain& chain) {
  Engine engine(chain);
  engine.prepare(Method::reach);
  Score all;
  double median = 0, p99 = 0;
  constexpr int rounds = 20;
  for (int round = 0; round < rounds; ++round) {
    const Score s = measure(chain, problems(chain, ProblemSet::random, 50000, 1000 + round),
                            contestant(engine, Method::reach), 1e-5, 1e-4, 1);
    all.targets += s.targets;
    all.failed += s.failed;
    median += s.median / rounds;
    p99 += s.p99 / rounds;
  }
  all.median = median;
  all.p99 = p99;
  print(chain.name + " a million", "reach", all);
}

void tracking(const Chain& chain, std::uint64_t seed) {
  const Packed packed(chain);
  const auto ours_of = [&](double largest) { return follower(chain, packed, 2 * largest / tick); };
  print(chain.name + " courses " + std::to_string(seed), "tracker", track(chain, 10, seed, ours_of));
  print("", "reacher", track(chain, 10, seed, [&](double largest) { return reacher(chain, 2 * largest / tick); }));
  print(chain.name + " out and back", "tracker", out_and_back(chain, 10, seed, follower(chain, packed, 10)));
}

void tracking_peers(const Chain& chain, std::uint64_t seed) {
  for (const auto& peer : peers_for(chain)) {
    print("", peer->name(), track(chain, 1, seed, [&](double) { return follower(*peer, 1e-3); }));
  }
}

// how far the answer to an unreachable target is from the best of a thousand descents
void residuals(const Chain& chain) {
  Engine engine(chain);
  const Packed& packed = engine.solver().packed();
  Random random(5);
  int within = 0;
  double worst = 0;
  const auto list = problems(chain, ProblemSet::unreachable, 200, 9);
  for (const Problem& problem : list) {
    const Goal goal(problem.target, true);
    const auto cost_of = [&](std::span<const double> q) {
      const Pose at = kinematics::forward(chain, q);
      const double turn = 2 * std::sin(0.5 * kinematics::rotation_distance(at.R, problem.target.R));
      return std::sqrt((at.p - problem.target.p).squaredNorm() + packed.length * packed.length * turn * turn);
    };
    std::vector<double> q(problem.start);
    (void)engine.solve(Method::reach, goal, {}, q);
    const double got = cost_of(q);
    double best = HUGE_VAL;
    DescentOptions options;
    options.iterations = 200;
    for (int start = 0; start < 1000; ++start) {
      for (int i = 0; i < chain.size(); ++i) q[i] = random.between(packed.lower[i], packed.upper[i]);
      best = std::min(best, std::sqrt(descend(packed, goal, options, q.data(), best_isa()).cost));
    }
    within += got <= 1.01 * best;
    worst = std::max(worst, got / best - 1);
  }
  std::printf(
      "\n%s out of reach: residual within 1%% of the best of 1000 starts for %d of %zu targets, worst %.2f%% above\n",
      chain.name.c_str(), within, list.size(), 100 * worst);
}

void closed_form() {
  const Chain chain = kinematics::arm11();
  const HumanArm arm = *HumanArm::recognize(chain);
  std::vector<double> rest;
  for (const kinematics::Joint& joint : chain.joints) rest.push_back(joint.rest);
  const Limb limb(arm, rest);
  Random random(3);
  constexpr int count = 4096;
  std::vector<double> targets(3 * count);
  std::vector<Limb::Answer> answers(count);
  for (int batch = 0; batch < count / 8; ++batch) {
    for (int lane = 0; lane < 8; ++lane) {
      std::vector<double> q = rest;
      for (int i = 6; i < 10; ++i) q[i] = random.between(chain.joints[i].lower, chain.joints[i].upper);
      const Eigen::Vector3d p = kinematics::forward(chain, q).p;
      for (int axis = 0; axis < 3; ++axis) targets[24 * batch + 8 * axis + lane] = p[axis];
    }
  }
  const auto clock = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
  };
  double one = HUGE_VAL, eight = HUGE_VAL, worst = 0;
  for (int pass = 0; pass < 50; ++pass) {
    double before = clock();
    for (int k = 0; k < count; ++k) {
      const double* t = &targets[24 * (k / 8) + k % 8];
      answers[k] = limb.solve({t[0], t[8], t[16]});
    }
    one = std::min(one, (clock() - before) / count);
    before = clock();
    for (int batch = 0; batch < count / 8; ++batch) limb.solve_eight(&targets[24 * batch], &answers[8 * batch]);
    eight = std::min(eight, (clock() - before) / count);
  }
  for (int k = 0; k < count; ++k) {
    const double* t = &targets[24 * (k / 8) + k % 8];
    std::vector<double> q = rest;
    std::copy_n(answers[k].q, 4, q.begin() + 6);
    worst = std::max(worst, (kinematics::forward(chain, q).p - Eigen::Vector3d(t[0], t[8], t[16])).norm());
  }
  std::printf("\nclosed form: %.0f ns a target, %.0f ns in batches of eight, largest error %.1e m\n", one, eight,
              worst);
}

// why a target is lost: whether anything connected with the posture before goes on along the course, at the same rate
void losses(const Chain& chain, std::uint64_t seed, int courses) {
  constexpr int horizon = 60, parts = 8;
  const Packed packed(chain);
  int counts[3] = {}, ticks[3] = {};
  for (int number = 0; number < courses; ++number) {
    const Course course(chain, lap, seed + number), fine(chain, parts * lap, seed + number);
    const Ways::Course at = [&](double t) {
      return kinematics::forward(chain, fine.posture(static_cast<int>(std::lround(parts * t))));
    };
    Ways::Options options;
    options.leap = 2 * course.largest_step() / parts;
    const Ways ways(chain, options);
    const Follower one = follower(chain, packed, 2 * course.largest_step() / tick);
    std::vector<double> q = course.posture(0);
    for (int settle = 0; settle < 2 * lap; ++settle) one.tick(at(0), q);
    int why = -1;
    for (int t = 1; t <= lap; ++t) {
      const std::vector<double> before = q;
      const Pose target = at(t);
      one.tick(target, q);
      const Pose X = kinematics::forward(chain, q);
      if ((X.p - target.p).norm() <= 1e-5 && kinematics::rotation_distance(X.R, target.R) <= 1e-4) {
        why = -1;
        continue;
      }
      if (why < 0) {
        const Ways::Posture last = Eigen::Map<const Eigen::VectorXd>(before.data(), chain.size());
        const int gone = ways.goes_on(last, at, t - 1, horizon);
        why = gone <= 1 ? 0 : gone < horizon ? 1 : 2;
        ++counts[why];
      }
      ++ticks[why];
    }
  }
  std::printf("%-22s losses (ticks): the way ends %d (%d), within %d ticks %d (%d), goes on %d (%d)\n",
              (chain.name + " courses " + std::to_string(seed)).c_str(), counts[0], ticks[0], horizon, counts[1],
              ticks[1], counts[2], ticks[2]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "ways") {
    for (const std::uint64_t seed : {100, 200, 300}) losses(kinematics::arm11(), seed, 10);
    losses(iiwa14(), 100, 10);
    losses(panda(), 100, 10);
    return 0;
  }
  std::printf("%-22s %-13s %8s %7s %10s %10s %11s %9s\n", "set", "solver", "targets", "failed", "median us", "p99 us",
              "median m", "rad");
  const Chain arm = kinematics::arm11();
  a_million(arm);
  sets_of(arm, 20000, 100);
  sets_of(iiwa14(), 10000, 50);
  sets_of(panda(), 10000, 50);
  const char* set = std::getenv("SAILOR_DATA");
  const std::string data = set ? set : std::string(SOURCE_DIR) + "/../shared/data";
  if (std::filesystem::exists(data + "/arm/humanSubject01_48dof.urdf")) {
    for (const auto& [base, tip] :
         {std::pair("T8", "RightHand"), std::pair("Pelvis", "RightToe"), std::pair("Pelvis", "LeftHand")}) {
      auto human = kinematics::read_urdf_chain(data + "/arm/humanSubject01_48dof.urdf", base, tip);
      if (!human) continue;
      human->name = std::string(tip) + "/" + std::to_string(human->size());
      sets_of(*human, 10000, 0);
    }
  }
  residuals(arm);
  closed_form();
  std::printf("\n%-22s %-13s %8s %7s %6s %10s %10s %9s %9s\n", "closed courses", "solver", "ticks", "failed", "jumps",
              "largest", "drift", "median us", "p99 us");
  for (const std::uint64_t seed : {100, 200, 300}) tracking(arm, seed);
  tracking_peers(arm, 100);
  tracking(iiwa14(), 100);
  tracking(panda(), 100);
}
