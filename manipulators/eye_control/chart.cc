#include "manipulators/eye_control/chart.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <vector>

#include "manipulators/eye_control/loop.h"
#include "manipulators/eye_control/methods.h"
#include "manipulators/eye_control/processor_time.h"
#include "manipulators/eye_control/simulate.h"
#include "objdb/text.h"

namespace eye {

namespace {

using loop::Scheme;
using loop::Solution;
using loop::Target;

// a CSV file under construction
class Sheet {
 public:
  explicit Sheet(std::string header) : text_(std::move(header) + "\n") {}

  Sheet& cell(double number) { return cell(std::isfinite(number) ? objdb::number(number) : std::string()); }
  Sheet& cell(std::string_view word) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += word;
    return *this;
  }
  void end() {
    text_ += '\n';
    first_ = true;
  }

  objdb::Status write(const std::filesystem::path& path) const {
    std::ofstream out(path);
    out << text_;
    out.flush();
    if (out) return {};
    return objdb::Error{objdb::ErrorKind::io, path.string() + ": error io the file cannot be written", 0};
  }

 private:
  std::string text_;
  bool first_ = true;
};

// -- work and precision

constexpr double length = 1.5;  // of every run that is timed, s

struct Errors {
  double largest, mean;  // deg/s; root mean square
};

// at the times that both have
Errors errors(const Solution& exact, const Solution& found) {
  Errors e{0, 0};
  int count = 0;
  for (size_t k = 0; k < found.velocity.size(); ++k) {
    const double place = static_cast<double>(k) * found.step / exact.step;
    if (std::abs(place - std::round(place)) > 1e-6) continue;
    const double difference = (found.velocity[k] - exact.velocity[static_cast<size_t>(std::llround(place))]) / deg;
    e.largest = std::max(e.largest, std::abs(difference));
    e.mean += difference * difference;
    ++count;
  }
  e.mean = std::sqrt(e.mean / count);
  return e;
}

// median of nine, microseconds for a simulated second
double cost(const std::function<void()>& run) {
  std::vector<double> times;
  for (int k = 0; k < 9; ++k) {
    const double start = processor_time();
    run();
    times.push_back(processor_time() - start);
  }
  std::nth_element(times.begin(), times.begin() + 4, times.end());
  return 1e6 * times[4] / length;
}

Sheet work_precision() {
  Sheet sheet("panel,method,step_ms,cpu_us_per_s,max_error_deg_s,rms_error_deg_s");
  const Parameters p;
  const Target ramp = [](double t, bool right) { return (right ? t >= 0 : t > 0) ? 10 * deg : 0; };
  const Target sine = [](double t, bool right) {
    return (right ? t >= 0 : t > 0) ? 20 * deg * std::cos(2 * pi * t) : 0;
  };
  const Solution exact_ramp = loop::reference(p, ramp, 0.001, length),
                 exact_sine = loop::reference(p, sine, 0.001, length);
  const std::vector<double> aligned{0.010, 0.005, 0.002, 0.001, 0.0005, 0.00025};
  const std::vector<double> frames{1.0 / 60, 1.0 / 90, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960};
  const struct {
    const char* name;
    const Target& target;
    const Solution& exact;
    const std::vector<double>& steps;
  } panels[] = {{"ramp_aligned", ramp, exact_ramp, aligned},
                {"ramp_frames", ramp, exact_ramp, frames},
                {"sine_aligned", sine, exact_sine, aligned}};
  for (const auto& panel : panels) {
    for (Scheme scheme : loop::schemes) {
      for (double step : panel.steps) {
        const Errors e = errors(panel.exact, loop::solve(scheme, p, panel.target, step, length));
        const double us = cost([&] { (void)loop::solve(scheme, p, panel.target, step, length); });
        sheet.cell(panel.name).cell(word(scheme)).cell(1e3 * step).cell(us).cell(e.largest).cell(e.mean).end();
      }
    }
  }
  return sheet;
}

// -- stability

// where growth changes sign between two values, by bisection; NaN if it does not
double boundary(const std::function<double(double)>& growth, double low, double high) {
  if (!(growth(low) < 0) || !(growth(high) > 0)) return NAN;
  for (int k = 0; k < 14; ++k) {
    const double middle = 0.5 * (low + high);
    (growth(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Sheet stability_gain() {
  Sheet sheet("mismatch_ms,analytic,measured_1ms,measured_5ms,measured_15ms");
  for (int mismatch = -60; mismatch <= 240; mismatch += 10) {
    Parameters p;
    p.visual_delay += 1e-3 * mismatch;
    const double analytic = loop::marginal_gain(p);
    sheet.cell(mismatch).cell(analytic > 4 ? NAN : analytic);
    for (double step : {0.001, 0.005, 0.015}) {
      if (step > p.visual_delay - 1e-9) {
        sheet.cell(NAN);
        continue;
      }
      sheet.cell(boundary(
          [&](double gain) {
            p.pursuit_gain = gain;
            return loop::measured_growth(p, step, 8);
          },
          0.2, 4));
    }
    sheet.end();
  }
  return sheet;
}

Sheet stability_local() {
  Sheet sheet("steps_per_delay,analytic_euler,measured_euler,analytic_trapezoid,measured_trapezoid");
  const double delay = 0.048;
  for (int steps : {1, 2, 3, 4, 5, 6, 8, 10, 14, 20, 28, 40, 56}) {
    sheet.cell(steps);
    for (bool trapezoid : {false, true}) {
      const auto growth = [&](double product) {
        return loop::measured_local_growth(product / delay, steps, delay, trapezoid);
      };
      sheet.cell(loop::marginal_local_product(steps, trapezoid)).cell(boundary(growth, 0.6, 2.4));
    }
    sheet.end();
  }
  return sheet;
}

// -- responses of the whole model

struct Sample {
  double time;
  Vec2 eye;         // in the head, deg
  double velocity;  // of pursuit, deg/s
  double speed;     // of the left eye, deg/s
  double vergence;  // deg
  double head;      // deg
};

std::vector<Sample> samples(FollowingWorld& world, const Parameters& p) {
  std::vector<Sample> result;
  simulate(world, std::make_shared<Parameters>(p), Frame::head, [&](const TraceRow& row, const Gaze& gaze) {
    result.push_back({row.time, (1 / deg) * gaze.aim().version, gaze.pursuit_velocity().x / deg,
                      std::abs(row.left_velocity) / deg, gaze.aim().vergence / deg, world.turned(row.time).x / deg});
  });
  return result;
}

FollowingWorld horizontal(const std::vector<std::pair<double, double>>& knots) {
  FollowingWorld world;
  for (const auto& [t, azimuth] : knots) world.target_track().add(t, {azimuth * deg, 0, 0});
  return world;
}

std::vector<Sample> ramp_response(double speed, Method method) {
  Parameters p;
  p.method = method;
  p.dead_zone = 0.5;
  FollowingWorld world = horizontal({{-0.1, 0}, {0, 0}, {0.8, 0.8 * speed}});
  return samples(world, p);
}

Sheet ramps() {
  Sheet sheet("t_s,v5_deg_s,v10_deg_s,v20_deg_s,v30_deg_s,v10_linear_deg_s");
  const auto a = ramp_response(5, Method::full), b = ramp_response(10, Method::full),
             c = ramp_response(20, Method::full), d = ramp_response(30, Method::full),
             e = ramp_response(10, Method::linear);
  for (size_t k = 0; k < a.size(); ++k) {
    sheet.cell(a[k].time).cell(a[k].velocity).cell(b[k].velocity).cell(c[k].velocity).cell(d[k].velocity);
    sheet.cell(e[k].velocity).end();
  }
  return sheet;
}

Sheet accelerations() {
  // people: de Brouwer et al., rightward and leftward means, deg/s^2
  Sheet sheet("speed_deg_s,model_deg_s2,people_right_deg_s2,people_left_deg_s2");
  const double people[][3] = {{5, 31, 37},    {10, 67, 59},   {15, 77, 72},   {20, 100, 100}, {25, 112, 110},
                              {30, 127, 116}, {35, 120, 128}, {40, 123, 125}, {45, 127, 163}};
  for (const auto& row : people) {
    const auto r = ramp_response(row[0], Method::full);
    sheet.cell(row[0]).cell(r[280].velocity / 0.1).cell(row[1]).cell(row[2]).end();
  }
  return sheet;
}

// amplitude and lag (ms) of pursuit against a sine of 20 deg/s peak, over the second half of eight cycles
std::pair<double, double> sine_response(double f, bool predictor) {
  Parameters p;
  p.predictor = predictor;
  FollowingWorld world;
  const double cycles = 8;
  const auto last = static_cast<int64_t>(std::llround(1000 * cycles / f));
  for (int64_t k = -200; k <= last; ++k) {
    const double t = static_cast<double>(k) / 1000;
    world.target_track().add(t, {k < 0 ? 0 : 20 * deg / (2 * pi * f) * std::sin(2 * pi * f * t), 0, 0});
  }
  double c = 0, s = 0;
  int count = 0;
  for (const Sample& sample : samples(world, p)) {
    if (sample.time < 0.5 * cycles / f || sample.time >= cycles / f - 1e-9) continue;
    c += sample.velocity * std::cos(2 * pi * f * sample.time);
    s += sample.velocity * std::sin(2 * pi * f * sample.time);
    ++count;
  }
  return {2 * std::hypot(c, s) / count / 20, 1e3 * std::atan2(s, c) / (2 * pi * f)};
}

Sheet sines() {
  Sheet sheet("frequency_hz,gain_predicted,lag_predicted_ms,gain_reactive,lag_reactive_ms");
  for (double f : {0.2, 0.3, 0.4, 0.5, 0.7, 0.85, 1.0, 1.25, 1.5, 1.75, 2.0}) {
    const auto with = sine_response(f, true), without = sine_response(f, false);
    sheet.cell(f).cell(with.first).cell(with.second).cell(without.first).cell(without.second).end();
  }
  return sheet;
}

std::vector<Sample> saccade(double amplitude) {
  FollowingWorld world = horizontal({{-0.3, 0}, {-0.2, 0}, {-0.2, amplitude}, {0.25, amplitude}});
  return samples(world, Parameters{});
}

Sheet main_sequence() {
  Sheet sheet("amplitude_deg,duration_ms,peak_deg_s");
  for (double a : {0.6, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0}) {
    double peak = 0, duration = 0;
    for (const Sample& s : saccade(a)) {
      peak = std::max(peak, s.speed);
      duration += s.speed > 20 ? 1 : 0;
    }
    sheet.cell(a).cell(duration).cell(peak).end();
  }
  return sheet;
}

Sheet profiles() {
  Sheet sheet("t_s,v2_deg_s,v5_deg_s,v10_deg_s,v20_deg_s,v40_deg_s");
  std::vector<std::vector<Sample>> all;
  for (double a : {2.0, 5.0, 10.0, 20.0, 40.0}) all.push_back(saccade(a));
  for (size_t k = 290; k < 460; ++k) {
    sheet.cell(all[0][k].time);
    for (const auto& one : all) sheet.cell(one[k].speed);
    sheet.end();
  }
  return sheet;
}

Sheet gaze_shift() {
  Sheet sheet("t_s,eye40_deg,head40_deg,eye120_deg,head120_deg");
  Parameters p;
  p.head_free = 1;
  std::vector<std::vector<Sample>> all;
  for (double a : {40.0, 120.0}) {
    FollowingWorld world = horizontal({{-0.2, 0}, {0, 0}, {0, a}, {1.2, a}});
    all.push_back(samples(world, p));
  }
  for (size_t k = 0; k < all[0].size(); ++k) {
    sheet.cell(all[0][k].time);
    for (const auto& one : all) sheet.cell(one[k].eye.x).cell(one[k].head);
    sheet.end();
  }
  return sheet;
}

Sheet vergence() {
  Sheet sheet("t_s,converging_deg,diverging_deg,with_saccade_deg,plain_feedback_deg");
  const auto nearness = [](double angle) { return 2 * std::tan(0.5 * angle * deg) / 0.063; };
  const auto step = [&](double from, double to, double azimuth, const Parameters& p) {
    FollowingWorld world;
    for (double t : {-0.1, 0.0}) world.target_track().add(t, {0, 0, nearness(from)});
    for (double t : {0.0, 1.5}) world.target_track().add(t, {azimuth * deg, 0, nearness(to)});
    return samples(world, p);
  };
  Parameters plain;
  plain.vergence_copy_gain = 0;
  plain.vergence_rate = 5;
  plain.vergence_step = 1;
  plain.vergence_limit = 5;
  const auto a = step(2, 6, 0, {}), b = step(6, 2, 0, {}), c = step(2, 6, 10, {}), d = step(2, 6, 0, plain);
  for (size_t k = 0; k < a.size(); ++k) {
    sheet.cell(a[k].time).cell(a[k].vergence).cell(b[k].vergence).cell(c[k].vergence).cell(d[k].vergence).end();
  }
  return sheet;
}

// -- beside the recordings that scripts/chart finds

// a cosine of the recorded pursuit: amplitude deg, period s. It has been followed for six periods before
Sheet recorded_pursuit() {
  Sheet sheet("condition,t_s,target_deg,eye_deg,smooth_deg_s");
  const struct {
    const char* name;
    double period;
  } conditions[] = {{"FS", 4.19}, {"SS", 5.12}};
  constexpr double amplitude = 14.61, before = 6;
  for (const auto& c : conditions) {
    FollowingWorld world;
    const auto target = [&](double t) { return amplitude * std::cos(2 * pi * t / c.period); };
    for (auto n = static_cast<int64_t>(-1000 * before * c.period); n <= static_cast<int64_t>(1000 * c.period); ++n) {
      const double t = static_cast<double>(n) / 1000;
      world.target_track().add(t, {target(t) * deg, 0, 0});
    }
    for (const Sample& s : samples(world, Parameters{})) {
      if (s.time < 0 || std::llround(1000 * s.time) % 10 != 0) continue;
      sheet.cell(c.name).cell(s.time).cell(target(s.time)).cell(s.eye.x).cell(s.velocity).end();
    }
  }
  return sheet;
}

// latencies of 400 saccades of 10 deg to and fro as LATER spreads them, ms, in order of size
Sheet latencies() {
  Parameters p;
  p.later_sigma = 1;
  FollowingWorld world;
  constexpr int count = 400;
  for (int k = 0; k <= count; ++k) {
    const double side = k % 2 ? 5 : -5;
    for (double t : {1.5 * k, 1.5 * (k + 1)}) world.target_track().add(t, {side * deg, 0, 0});
  }
  std::vector<double> found;
  Mode before = Mode::fixation;
  double since = 0;
  simulate(world, std::make_shared<Parameters>(p), Frame::head, [&](const TraceRow& row, const Gaze&) {
    const double phase = std::fmod(row.time + 1e-9, 1.5);
    if (phase < since) before = Mode::fixation;
    since = phase;
    if (row.mode == Mode::saccade && before != Mode::saccade && row.time > 1.5) found.push_back(1e3 * phase);
    before = row.mode;
  });
  std::sort(found.begin(), found.end());
  Sheet sheet("share,latency_ms");
  for (size_t k = 0; k < found.size(); ++k) {
    sheet.cell((static_cast<double>(k) + 0.5) / static_cast<double>(found.size())).cell(found[k]).end();
  }
  return sheet;
}

// what each method costs and is worth
Sheet methods() {
  Sheet sheet("method,error_deg,ns_per_figure_step");
  for (const MethodRow& row : method_table()) {
    sheet.cell(word(row.method)).cell(measured_error(row.method) / deg).cell(1e9 * measured_cost(row.method)).end();
  }
  return sheet;
}

}  // namespace

objdb::Status write_charts(const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return objdb::Error{objdb::ErrorKind::io, folder + ": error io " + failed.message(), 0};
  const struct {
    const char* name;
    Sheet (*make)();
  } sheets[] = {{"work_precision", work_precision},
                {"stability_gain", stability_gain},
                {"stability_local", stability_local},
                {"ramps", ramps},
                {"accelerations", accelerations},
                {"sines", sines},
                {"main_sequence", main_sequence},
                {"profiles", profiles},
                {"gaze_shift", gaze_shift},
                {"vergence", vergence},
                {"recorded_pursuit", recorded_pursuit},
                {"latencies", latencies},
                {"methods", methods}};
  for (const auto& sheet : sheets) {
    const auto path = std::filesystem::path(folder) / (std::string(sheet.name) + ".csv");
    if (auto status = sheet.make().write(path); !status) return status;
  }
  return {};
}

}  // namespace eye
