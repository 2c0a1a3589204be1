#include "manipulators/eye_control/loop.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "manipulators/eye_control/lag.h"

namespace eye::loop {

namespace {

constexpr std::array<std::string_view, 6> words{"euler", "zoh", "heun", "foh", "rk4_linear", "rk4_hermite"};

// command, eye velocity, copy
using State = std::array<double, 3>;

double visual(double seen, const Parameters& p, bool linear) {
  return p.pursuit_gain * (linear ? seen : std::clamp(seen, -p.velocity_limit, p.velocity_limit));
}

double acceleration(double error, const Parameters& p, bool linear) {
  const double wanted = p.local_gain * error;
  return linear ? wanted : wanted / (1 + std::abs(wanted) / p.acceleration_limit);
}

// the past of the state on the grid, with the derivatives at both ends of every step
class Past {
 public:
  Past(double step, bool hermite) : step_(step), hermite_(hermite) {}

  void push(const State& x) { state_.push_back(x); }
  void slopes(const State& begin, const State& end) {
    begin_.push_back(begin);
    end_.push_back(end);
  }
  const State& last() const { return state_.back(); }

  double at(double t, int part) const {
    const double place = t / step_;
    if (place <= 0) return state_[0][static_cast<size_t>(part)];
    // a time on the grid, up to rounding, is that node
    const double nearest = std::round(place);
    const auto p = static_cast<size_t>(part);
    if (std::abs(place - nearest) < 1e-7) return state_[static_cast<size_t>(nearest)][p];
    const auto k = static_cast<size_t>(place);
    const double s = place - static_cast<double>(k), a = state_[k][p], b = state_[k + 1][p];
    if (!hermite_) return a + s * (b - a);
    const double u = 1 - s;
    return u * u * (1 + 2 * s) * a + s * s * (3 - 2 * s) * b + step_ * s * u * (u * begin_[k][p] - s * end_[k][p]);
  }

 private:
  double step_;
  bool hermite_;
  std::vector<State> state_, begin_, end_;
};

}  // namespace

std::string_view word(Scheme scheme) { return words[static_cast<size_t>(scheme)]; }

Solution solve(Scheme scheme, const Parameters& p, const Target& target, double step, double end, bool linear) {
  const bool slopes = scheme == Scheme::rk4_hermite || scheme == Scheme::rk4_linear;
  Past past(step, scheme == Scheme::rk4_hermite);
  past.push({0, 0, 0});
  const Lag plant(p.plant_time, step), copy(p.copy_plant_time, step);

  // what drives the step at time t: the rate of c and the inputs of v and w
  const auto drive = [&](double t, bool right) -> State {
    const double seen = target(t - p.visual_delay, right) - past.at(t - p.visual_delay, 1) +
                        p.copy_gain * past.at(t - p.copy_visual_delay, 2);
    const double error = visual(seen, p, linear) - past.at(t - p.local_delay, 0);
    return {acceleration(error, p, linear), past.at(t - p.motor_delay, 0), past.at(t - p.copy_motor_delay, 0)};
  };
  const auto rate = [&](const State& d, const State& x) -> State {
    return {d[0], (d[1] - x[1]) / p.plant_time, (d[2] - x[2]) / p.copy_plant_time};
  };
  const auto moved = [](const State& x, double h, const State& f) -> State {
    return {x[0] + h * f[0], x[1] + h * f[1], x[2] + h * f[2]};
  };

  const auto count = static_cast<int64_t>(std::llround(end / step));
  Solution solution{step, {0}};
  solution.velocity.reserve(static_cast<size_t>(count) + 1);
  for (int64_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) * step;
    const State x = past.last(), d0 = drive(t, true);
    State next{};
    switch (scheme) {
      case Scheme::euler: next = moved(x, step, rate(d0, x)); break;
      case Scheme::zoh:
        next = {x[0] + step * d0[0], plant.advance(x[1], d0[1], d0[1]), copy.advance(x[2], d0[2], d0[2])};
        break;
      case Scheme::heun: {
        const State d1 = drive(t + step, false), f0 = rate(d0, x), f1 = rate(d1, moved(x, step, f0));
        for (size_t i = 0; i < 3; ++i) next[i] = x[i] + 0.5 * step * (f0[i] + f1[i]);
        break;
      }
      case Scheme::foh: {
        const State d1 = drive(t + step, false);
        next = {x[0] + 0.5 * step * (d0[0] + d1[0]), plant.advance(x[1], d0[1], d1[1]),
                copy.advance(x[2], d0[2], d1[2])};
        break;
      }
      case Scheme::rk4_linear:
      case Scheme::rk4_hermite: {
        const State dh = drive(t + 0.5 * step, true), d1 = drive(t + step, false);
        const State a = rate(d0, x), b = rate(dh, moved(x, 0.5 * step, a)), c = rate(dh, moved(x, 0.5 * step, b)),
                    d = rate(d1, moved(x, step, c));
        for (size_t i = 0; i < 3; ++i) next[i] = x[i] + step / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
        if (slopes) past.slopes(a, rate(d1, next));
        break;
      }
    }
    past.push(next);
    solution.velocity.push_back(next[1]);
  }
  return solution;
}

namespace {

// zeros of the Legendre polynomial of degree m by Newton's method, moved to [0, 1]
template <int m>
Eigen::Matrix<double, m, 1> legendre_nodes() {
  Eigen::Matrix<double, m, 1> nodes;
  for (int k = 0; k < m; ++k) {
    double x = -std::cos(pi * (k + 0.75) / (m + 0.5));
    for (int round = 0; round < 8; ++round) {
      double before = 1, here = x;
      for (int n = 2; n <= m; ++n) before = std::exchange(here, ((2 * n - 1) * x * here - (n - 1) * before) / n);
      x -= here * (x * x - 1) / (m * (x * here - before));
    }
    nodes[k] = 0.5 * (x + 1);
  }
  return nodes;
}

}  // namespace

Solution reference(const Parameters& p, const Target& target, double interval, double end) {
  // eight Gauss-Legendre nodes on [0, 1] and the matrix that integrates their interpolant to each node and to 1
  constexpr int m = 8;
  using Column = Eigen::Matrix<double, m, 1>;
  const Column x = legendre_nodes<m>();
  Eigen::Matrix<double, m, m> powers, integrals;
  Column whole;
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < m; ++i) {
      powers(i, j) = std::pow(2 * x[i] - 1, j);
      integrals(i, j) = (std::pow(2 * x[i] - 1, j + 1) - std::pow(-1.0, j + 1)) / (2.0 * (j + 1));
    }
    whole[j] = (1 - std::pow(-1.0, j + 1)) / (2.0 * (j + 1));
  }
  const Eigen::Matrix<double, m, m> inverse = powers.inverse();
  const Eigen::Matrix<double, m, m> Q = integrals * inverse;
  const Eigen::Matrix<double, 1, m> weights = whole.transpose() * inverse;

  struct Interval {
    Column c, v, w;
  };
  const auto count = static_cast<int64_t>(std::llround(end / interval));
  std::vector<Interval> past;
  const Interval rest{Column::Zero(), Column::Zero(), Column::Zero()};
  const auto ago = [&](int64_t k, double delay) -> const Interval& {
    const int64_t index = k - std::llround(delay / interval);
    return index < 0 ? rest : past[static_cast<size_t>(index)];
  };
  // v' = (i - v) / T over the interval, at the nodes: (I + h/T Q) V = v0 + h/T Q I
  const auto lagged = [&](double start, const Column& input, double time) {
    const Eigen::Matrix<double, m, m> A = Eigen::Matrix<double, m, m>::Identity() + interval / time * Q;
    return Column(A.partialPivLu().solve(Column::Constant(start) + interval / time * (Q * input)));
  };

  double c = 0, v = 0, w = 0;
  Solution solution{interval, {0}};
  for (int64_t k = 0; k < count; ++k) {
    Column rate;
    const Interval &seen = ago(k, p.visual_delay), &copied = ago(k, p.copy_visual_delay),
                   &local = ago(k, p.local_delay);
    for (int i = 0; i < m; ++i) {
      const double t = (static_cast<double>(k) + x[i]) * interval - p.visual_delay;
      const double That = target(t, true) - seen.v[i] + p.copy_gain * copied.w[i];
      rate[i] = acceleration(visual(That, p, false) - local.c[i], p, false);
    }
    Interval now;
    now.c = Column::Constant(c) + interval * (Q * rate);
    const Column input = ago(k, p.motor_delay).c, copy_input = ago(k, p.copy_motor_delay).c;
    now.v = lagged(v, input, p.plant_time);
    now.w = lagged(w, copy_input, p.copy_plant_time);
    c += interval * weights.dot(rate);
    v += interval / p.plant_time * weights.dot(input - now.v);
    w += interval / p.copy_plant_time * weights.dot(copy_input - now.w);
    past.push_back(now);
    solution.velocity.push_back(v);
  }
  return solution;
}

std::complex<double> open_loop(std::complex<double> s, const Parameters& p) {
  const std::complex<double> F = p.local_gain * std::exp(-s * p.motor_delay) /
                                 ((s + p.local_gain * std::exp(-s * p.local_delay)) * (1.0 + s * p.plant_time));
  return F * (std::exp(-s * p.visual_delay) - p.copy_gain * std::exp(-s * p.copy_visual_delay));
}

double marginal_gain(const Parameters& p) {
  // P G = -1: the imaginary part of G vanishes while the real part is negative
  double best = HUGE_VAL;
  const auto G = [&](double w) { return open_loop({0, w}, p); };
  double before = G(1e-3).imag();
  for (double w = 0.05; w < 2 * pi * 20; w += 0.05) {
    const double here = G(w).imag();
    if (before * here < 0) {
      double a = w - 0.05, b = w;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (a + b);
        (G(middle).imag() * before > 0 ? a : b) = middle;
      }
      const double real = G(a).real();
      if (real < 0) best = std::min(best, -1 / real);
    }
    before = here;
  }
  return best;
}

double marginal_local_product(int steps, bool trapezoid) {
  return trapezoid ? 2 * steps * std::tan(pi / (4 * steps)) : 2 * steps * std::sin(pi / (2 * (2 * steps + 1)));
}

double measured_growth(const Parameters& p, double step, double length) {
  const Target push = [](double t, bool right) {
    return (right ? t >= 0 : t > 0) && (right ? t < 0.06 : t <= 0.06) ? 1.0 : 0.0;
  };
  const Solution s = solve(Scheme::foh, p, push, step, length, true);
  double early = 0, late = 0;
  for (size_t k = s.velocity.size() / 2; k < s.velocity.size(); ++k) {
    double& largest = k < s.velocity.size() * 3 / 4 ? early : late;
    largest = std::max(largest, std::abs(s.velocity[k]));
  }
  return std::log(late / early) / (0.25 * length);
}

double measured_local_growth(double gain, int steps, double delay, bool trapezoid) {
  const double h = delay / steps;
  std::vector<double> c(static_cast<size_t>(steps) + 1, 0);
  c.back() = 1;
  const auto total = static_cast<size_t>(std::llround(60 * delay / h));
  double early = 0, late = 0;
  for (size_t k = 0; k < total; ++k) {
    const size_t n = c.size() - 1, d = static_cast<size_t>(steps);
    c.push_back(c[n] - h * gain * (trapezoid ? 0.5 * (c[n - d] + c[n + 1 - d]) : c[n - d]));
    if (k > total / 2) {
      double& largest = k < total * 3 / 4 ? early : late;
      largest = std::max(largest, std::abs(c.back()));
    }
  }
  return std::log(late / early) / (0.25 * 60 * delay);
}

}  // namespace eye::loop
