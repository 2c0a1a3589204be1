#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// How much of the model moves the eyes, from cheap to complete.
enum class Method {
  snap,          ///< geometry alone: the eyes point at the target at once
  saccade_only,  ///< saccades, vergence and reflexes; no pursuit
  linear,        ///< pursuit without saturations, switch and predictor
  full
};

/// What the eyes are doing.
enum class Mode { fixation, latency, saccade, pursuit, vergence, blink };

std::string_view word(Method method);
std::string_view word(Mode mode);
std::optional<Method> method_of(std::string_view word);

/// Every constant of the model, SI and radians. The values are reconstructions (see docs/eye.md): the paper prints
/// none. `parameter_table` gives each its unit, bounds and source; delays are used in whole internal steps.
struct Parameters {
  // pursuit: retina, visual estimate, local premotor loop, plant
  double visual_delay = 0.070;
  double visual_lag = 0;
  double motor_delay = 0.030;
  double local_delay = 0.048;
  double local_gain = 15.6;
  double pursuit_gain = 0.95;
  double acceleration_limit = 300 * deg;
  double velocity_limit = 100 * deg;
  double plant_time = 0.015;

  // efference copy: what the brain believes about the loop above
  double copy_gain = 1;
  double copy_visual_delay = 0.070;
  double copy_motor_delay = 0.030;
  double copy_plant_time = 0.015;

  // onset and offset
  double offset_switch = 1;
  double offset_time = 0.090;
  double offset_hold = 0.010;
  double pursuit_on = 1.0 * deg;
  double pursuit_off = 0.5 * deg;
  double slip_noise = 0;

  // predictor
  double predictor = 1;
  double predictor_period = 0.080;
  double predictor_memory = 0.99;
  double position_rate = 2;

  // saccades
  double saccade_latency = 0.200;
  double catch_up_latency = 0.125;
  double later_sigma = 0;
  double saccade_gain = 1;
  double dead_zone = 0.5 * deg;
  double smooth_from = 0.040;
  double smooth_to = 0.180;
  double dead_time = 0.080;
  double burst_speed = 518 * deg;
  double burst_angle = 6.95 * deg;
  double burst_rise = 0.0045;
  double burst_lag = 0.0027;
  double burst_stop = 1.3 * deg;

  // final common path
  double long_plant_time = 0.224;
  double plant_estimate = 1;
  double integrator_time = 0;
  double range = 50 * deg;
  double eye_range = 55 * deg;
  double listing_tilt = 0;

  // reflexes
  double vor_gain = 0.97;
  double vor_latency = 0.0086;
  double optokinetic_gain = 0.5;
  double optokinetic_time = 15;

  // vergence
  double vergence_latency = 0.160;
  double vergence_rate = 3;
  double vergence_copy_gain = 1;
  double vergence_limit = 15 * deg;
  double vergence_step = 0.67 * deg;
  double vergence_burst_speed = 40 * deg;
  double vergence_burst_angle = 5 * deg;
  double convergence_saccade_rate = 16;
  double divergence_saccade_rate = 22;

  // head
  double head_free = 0;
  double head_share = 0.79;
  double head_threshold = 20 * deg;
  double head_time = 0.45;

  // what never rests, off by default
  double drift_speed = 0;
  double drift_time = 0.1;
  double microsaccade_rate = 0;
  double microsaccade_size = 0.3 * deg;
  double blink_rate = 0;
  double blink_closing = 0.066;
  double blink_opening = 0.095;
  double blink_depth = 0.9;
  double seed = 1;

  double eye_distance = 0.063;
  double step = 0.001;
  Method method = Method::full;

  /// A delay in whole internal steps, at least 1.
  int steps(double delay) const;

  bool operator==(const Parameters&) const = default;
};

/// One row of the table of parameters: everything the language, the command line and the documentation need.
struct Parameter {
  std::string_view name;
  std::string_view unit;  ///< "s", "rad", "rad/s", "rad/s^2", "1/s", "m", "" for a plain number, "switch" for 0 or 1
  double Parameters::*value;
  double low, high;  ///< bounds, both allowed
  std::string_view doc;
  std::string_view source;

  bool is_switch() const { return unit == "switch"; }
  /// The unit as the language writes it.
  std::string_view wire_unit() const { return is_switch() ? "" : unit == "1/s" ? "Hz" : unit; }
};

std::span<const Parameter> parameter_table();

/// The row of that name, or nothing.
const Parameter* find_parameter(std::string_view name);

/// Why this set of parameters cannot be run, as one sentence, or nothing. Checks every bound and that the delays that
/// the fixed step quantises are at least one step.
std::optional<std::string> fault(const Parameters& parameters);

}  // namespace eye
