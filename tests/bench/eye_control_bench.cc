#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "manipulators/eye_control/gaze.h"
#include "manipulators/eye_control/loop.h"
#include "manipulators/eye_control/processor_time.h"

// What the eyes cost, beside simpler ways in the same run. An eye-axis millisecond is one component of one eye over one
// internal step; a figure has four (two eyes, horizontal and vertical), and vergence besides.

namespace {

using namespace eye;

// median over `rounds` of the processor time of one call, s
template <class Call>
double median(int rounds, Call&& call) {
  std::vector<double> times;
  for (int k = 0; k < rounds; ++k) {
    const double start = processor_time();
    call();
    times.push_back(processor_time() - start);
  }
  std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
  return times[static_cast<size_t>(rounds / 2)];
}

// what one pair of eyes meets: back and forth at 9 deg/s with its own phase, and a jump of 6 deg now and then; whole
// numbers, so that making it costs little beside what is measured
Stimulus meet(int64_t n, int figure) {
  Stimulus s;
  const auto k = static_cast<uint32_t>(n + 300) + 251u * static_cast<uint32_t>(figure);
  const auto saw = [](uint32_t step) { return 1e-3 * std::abs(static_cast<int>(step & 4095u) - 2048); };
  const double jump = (k + 777u) & 2048u ? 0.1 : 0, here = saw(k), next = saw(k + 1);
  s.seen_from = {0.16 * here + jump, 0.04 * here};
  s.seen_to = {0.16 * next + jump, 0.04 * next};
  s.visible = true;
  s.seen_vergence = 0.05;
  s.goal = {s.seen_to, 0.05, false};
  return s;
}

void one_figure() {
  const auto p = std::make_shared<Parameters>();
  Gaze gaze(p);
  int64_t n = 0;
  const int steps = 20000;
  double sum = 0;
  const double filling = median(9, [&] {
    for (int k = 0; k < steps; ++k) sum += meet(k, 3).seen_to.x;
  });
  const double whole = median(9, [&] {
    for (int k = 0; k < steps; ++k) gaze.advance(meet(n++, 3));
  });
  const double ns = 1e9 * (whole - filling) / steps;
  std::printf("whole model, one figure        %8.1f ns/ms   %6.1f ns per eye-axis ms   (checksum %.3g)\n", ns, ns / 4,
              sum + gaze.aim().version.x);
}

void schemes() {
  const Parameters p;
  const loop::Target ramp = [](double t, bool right) { return (right ? t >= 0 : t > 0) ? 10 * deg : 0; };
  for (loop::Scheme scheme : loop::schemes) {
    const double time = median(9, [&] { (void)loop::solve(scheme, p, ramp, 0.001, 3); });
    std::printf("pursuit loop alone, %-11s%8.1f ns/ms of one axis\n", std::string(word(scheme)).c_str(),
                1e9 * time / 3000);
  }
}

// `count` figures over one simulated second in ticks of 1/60 s, W side by side
template <int W>
void crowd(int count) {
  const auto p = std::make_shared<Parameters>();
  std::vector<std::unique_ptr<Gazes<W>>> blocks;
  for (int k = 0; k < count; k += W) blocks.push_back(std::make_unique<Gazes<W>>(p));
  std::vector<Stimulus> met(static_cast<size_t>(W));
  double making = 0;
  const auto second = [&](bool moving) {
    const double start = processor_time();
    for (int tick = 1; tick <= 60; ++tick) {
      const int from = 1000 * (tick - 1) / 60, to = 1000 * tick / 60;
      for (size_t b = 0; b < blocks.size(); ++b) {
        for (int n = from; n < to; ++n) {
          for (int i = 0; i < W; ++i) met[static_cast<size_t>(i)] = meet(n, static_cast<int>(b) * W + i);
          if (moving) blocks[b]->advance(met.data());
          making += met[0].seen_to.x;
        }
      }
    }
    return processor_time() - start;
  };
  const double filling = second(false), time = second(true) - filling;
  std::printf(
      "whole model, %5d figures by %d %8.3f s of one core per simulated second, %6.1f ns per eye-axis ms (%.2g)\n",
      count, W, time, 1e9 * time / (4000.0 * count), making);
}

}  // namespace

int main() {
  std::printf(
      "floor: a figure's step reads 48 remembered numbers and writes 16 (512 bytes), 230 operations, 5 roots and 6\n"
      "divisions: 10 000 figures in real time are 5 GB and 2.3 G operations a second, 25 ns an eye-axis ms\n"
      "processor time, medians; the machine may be shared\n");
  one_figure();
  schemes();
  crowd<1>(1000);
  crowd<8>(1000);
  crowd<1>(10000);
  crowd<8>(10000);
  return 0;
}
