#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/manipulators/eye_control/course_runs.h"
#include "tests/manipulators/eye_control/report.h"

// Eyes that something is wrong with: each swings or beats at the frequency that analysis gives. docs/eye.md has the
// commands.
namespace eye::test {
namespace {

// frequency (Hz) and size (peak to peak) of what a course does around its mean from a time on
struct Swing {
  double frequency = 0, size = 0;
};

Swing swing(const Course& r, const std::vector<double>& x, double from) {
  const size_t begin = r.index(from);
  double mean = 0, low = HUGE_VAL, high = -HUGE_VAL;
  for (size_t k = begin; k < x.size(); ++k) {
    mean += x[k] / static_cast<double>(x.size() - begin);
    low = std::min(low, x[k]);
    high = std::max(high, x[k]);
  }
  double first = 0, last = 0;
  int count = -1;
  for (size_t k = begin + 1; k < x.size(); ++k) {
    if (!(x[k - 1] < mean && x[k] >= mean)) continue;
    last = r.t[k] - (x[k] - mean) / (x[k] - x[k - 1]) * (r.t[1] - r.t[0]);
    if (++count == 0) first = last;
  }
  return {count > 0 ? count / (last - first) : 0, high - low};
}

Parameters patient() {
  Parameters p;
  p.dead_zone = 0.5;  // no saccade hides pursuit
  p.predictor = 0;
  return p;
}

const std::vector<At> slow_ramp{{-0.2, 0}, {0, 0}, {4, 40}};

TEST(Patients, AnUndampedLocalLoopSwingsAtAQuarterOfItsDelay) {
  // infantile nystagmus: c' = -K c(t - tm) is marginal at K tm = pi / 2, and there, or saturated beyond, a period is
  // four delays
  for (double product : {0.75, 1.0}) {
    Parameters p = patient();
    p.local_gain = product / p.local_delay;
    const Course r = follow(slow_ramp, p);
    EXPECT_LT(swing(r, r.velocity, 3).size, 0.01) << product;
  }
  for (double gain : {35.0, 38.0}) {
    Parameters p = patient();
    p.local_gain = gain;
    const Course r = follow(slow_ramp, p);
    const Swing s = swing(r, r.velocity, 2);
    report("patient", "local gain %.0f /s: swings at %.2f Hz (theory 1 / 4 tm = %.2f), %.1f deg/s from side to side",
           gain, s.frequency, 1 / (4 * p.local_delay), s.size);
    EXPECT_NEAR(s.frequency, 1 / (4 * p.local_delay), 0.02);
    EXPECT_GT(s.size, 1);
  }
}

// harmonic balance of the loop without copy: the frequency at which
// -K (P e^{-s (to + tv)} / (1 + s T2) + e^{-s tm}) / s is real, Hz
double without_copy(double gain) {
  const Parameters p;
  const auto imaginary = [&](double w) {
    const std::complex<double> s(0, w);
    return (-p.local_gain *
            (gain * std::exp(-s * (p.motor_delay + p.visual_delay)) / (1.0 + s * p.plant_time) +
             std::exp(-s * p.local_delay)) /
            s)
        .imag();
  };
  double w = 10;
  while (imaginary(w) * imaginary(w + 0.001) > 0) w += 0.001;
  return (w + 0.0005) / (2 * pi);
}

TEST(Patients, WithoutTheCopyPursuitSwings) {
  for (double gain : {0.8, 0.9, 0.95}) {
    Parameters p = patient();
    p.copy_gain = 0;
    p.pursuit_gain = gain;
    const Course r = follow(slow_ramp, p);
    const Swing s = swing(r, r.velocity, 2);
    report("patient", "no copy, P = %.2f: swings at %.3f Hz (harmonic balance %.3f), %.1f deg/s from side to side",
           gain, s.frequency, without_copy(gain), s.size);
    EXPECT_NEAR(s.frequency, without_copy(gain), 0.015 * s.frequency);
    EXPECT_GT(s.size, 1);
  }
}

TEST(Patients, PredictionTakesTheSwingOfAnUnknownDelayAway) {
  for (double predictor : {0.0, 1.0}) {
    Parameters p = patient();
    p.visual_delay = 0.27;
    p.predictor = predictor;
    const Course r = follow({{-0.2, 0}, {0, 0}, {0.5, 5}, {20, 5}}, p);
    const Swing s = swing(r, r.velocity, 12);
    report("patient", "eyes that see 200 ms later than the copy believes, %s prediction: %.1f deg/s from side to side",
           predictor != 0 ? "with" : "without", s.size);
    if (predictor != 0) {
      EXPECT_LT(s.size, 0.1);
    } else {
      EXPECT_NEAR(s.size, 50.5, 1);
    }
  }
}

TEST(Patients, ALeakyIntegratorBeatsBackToTheTarget) {
  // gaze-evoked nystagmus: drift home with the leak's time constant, saccades out again. One beat takes the time from
  // the dead zone to a saccade, and that of the drift through it: latency + T ln(E / (E - dead zone))
  Parameters p;
  p.integrator_time = 2;
  p.optokinetic_gain = 0;
  p.pursuit_on = 0.9;  // the drift is not pursued
  p.pursuit_off = 0.1;
  const Course r = follow({{0, 0}, {0.1, 0}, {0.101, 20}, {6, 20}}, p);
  double first = 0, last = 0;
  int beats = -1;
  for (size_t k = r.index(1); k < r.t.size(); ++k) {
    if (r.mode[k] != Mode::saccade || r.mode[k - 1] == Mode::saccade) continue;
    last = r.t[k];
    if (++beats == 0) first = last;
  }
  const double theory = p.saccade_latency + p.integrator_time * std::log(20 / (20 - p.dead_zone / deg));
  report("patient", "integrator that leaks with 2 s, 20 deg aside: %.2f beats a second (theory %.2f)",
         beats / (last - first), 1 / theory);
  EXPECT_GT(beats, 10);
  EXPECT_NEAR((last - first) / beats, theory, 0.02 * theory);
  // drift speed between saccades: position over time constant, 10 deg/s
  size_t k = r.index(4);
  while (r.mode[k] == Mode::saccade || r.mode[k + 20] == Mode::saccade) ++k;
  EXPECT_NEAR((r.position[k + 10] - r.position[k]) / 0.01, -r.position[k] / 2, 0.2);
}

TEST(Patients, VergenceWithoutItsCopySwingsAtAQuarterOfItsDelay) {
  // limited in speed it is a relay with a delay: a period is four times latency and muscle
  Parameters p;
  p.vergence_copy_gain = 0;
  p.vergence_rate = 40;
  p.vergence_step = 1;  // no fast component
  p.vergence_limit = 5 * deg;
  FollowingWorld world;
  for (double t : {-0.3, -0.001, 0.0, 12.0}) world.target_track().add(t, {0, 0, t < 0 ? 1.5 : 2});
  const Course r = run(world, p);
  const Swing s = swing(r, r.vergence, 4);
  const double theory = 1 / (4 * (p.vergence_latency + p.plant_time));
  report("patient", "vergence without copy: swings at %.3f Hz (theory %.3f), %.2f deg from side to side", s.frequency,
         theory, s.size);
  EXPECT_NEAR(s.frequency, theory, 0.04 * theory);
  EXPECT_GT(s.size, 0.5);
}

TEST(Patients, ModesDoNotFlicker) {
  // a saccade that is called off, since pursuit has brought the eye there, is none: what is called one lasts
  Parameters p;
  p.integrator_time = 2;
  const Course r = follow({{0, 0}, {0.1, 0}, {0.101, 20}, {6, 20}}, p);
  size_t since = 0;
  for (size_t k = 1; k < r.t.size(); ++k) {
    if (r.mode[k] == r.mode[k - 1]) continue;
    if (r.mode[k - 1] == Mode::saccade) {
      EXPECT_GE(k - since, 8u) << r.t[k];
    }
    since = k;
  }
}

}  // namespace
}  // namespace eye::test
