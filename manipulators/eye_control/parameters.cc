#include "manipulators/eye_control/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace eye {

namespace {

constexpr std::array<std::string_view, 4> method_words{"snap", "saccade_only", "linear", "full"};
constexpr std::array<std::string_view, 6> mode_words{"fixation", "latency", "saccade", "pursuit", "vergence", "blink"};

constexpr std::string_view ours = "reconstruction";

constexpr auto table = std::to_array<Parameter>({
    {"visual_delay", "s", &Parameters::visual_delay, 0.001, 1, "retina to reconstructed target velocity",
     "Robinson, Gordon and Gordon 1986: 100 ms in all; the split is ours"},
    {"visual_lag", "s", &Parameters::visual_lag, 0, 0.2, "first-order lag after the visual delay; 0 is none", ours},
    {"motor_delay", "s", &Parameters::motor_delay, 0.001, 0.3, "premotor command to muscle", ours},
    {"local_delay", "s", &Parameters::local_delay, 0.001, 0.3, "delay of the local premotor loop",
     "chosen for ringing at 3.8 Hz"},
    {"local_gain", "1/s", &Parameters::local_gain, 0, 200, "gain of the local premotor loop",
     "chosen for ringing at 3.8 Hz"},
    {"pursuit_gain", "", &Parameters::pursuit_gain, 0, 3, "steady gain of smooth pursuit",
     "Robinson, Gordon and Gordon 1986: mean 0.95"},
    {"acceleration_limit", "rad/s^2", &Parameters::acceleration_limit, 0.01, 1000,
     "soft limit of eye acceleration (AS)", "fits initial accelerations of de Brouwer et al."},
    {"velocity_limit", "rad/s", &Parameters::velocity_limit, 0.01, 100, "limit of seen target speed (VS)",
     "Meyer, Lasker and Robinson 1985, second hand"},
    {"plant_time", "s", &Parameters::plant_time, 0.001, 3, "short time constant of the eye plant", ours},
    {"copy_gain", "", &Parameters::copy_gain, 0, 4, "gain of the efference copy; 1 is healthy", ours},
    {"copy_visual_delay", "s", &Parameters::copy_visual_delay, 0.001, 1, "visual delay the efference copy believes in",
     ours},
    {"copy_motor_delay", "s", &Parameters::copy_motor_delay, 0.001, 0.3, "motor delay the efference copy believes in",
     ours},
    {"copy_plant_time", "s", &Parameters::copy_plant_time, 0.001, 3, "plant time the efference copy believes in", ours},
    {"offset_switch", "switch", &Parameters::offset_switch, 0, 1, "1: pursuit is switched off, not followed to rest",
     ours},
    {"offset_time", "s", &Parameters::offset_time, 0.005, 2, "time constant of the end of pursuit",
     "Robinson, Gordon and Gordon 1986: 90 ms"},
    {"offset_hold", "s", &Parameters::offset_hold, 0, 1, "how long the target must seem still before pursuit ends",
     ours},
    {"pursuit_on", "rad/s", &Parameters::pursuit_on, 0, 1, "target speed that starts pursuit", ours},
    {"pursuit_off", "rad/s", &Parameters::pursuit_off, 0, 1, "target speed below which pursuit ends", ours},
    {"slip_noise", "rad/s", &Parameters::slip_noise, 0, 1, "standard deviation of seen velocity, each millisecond",
     ours},
    {"predictor", "switch", &Parameters::predictor, 0, 1, "1: adaptive prediction of target motion", ours},
    {"predictor_period", "s", &Parameters::predictor_period, 0.01, 0.2, "box over which seen velocity is averaged",
     ours},
    {"predictor_memory", "", &Parameters::predictor_memory, 0.5, 1, "forgetting factor a box", ours},
    {"position_rate", "1/s", &Parameters::position_rate, 0, 5, "position error closed by predictive pursuit", ours},
    {"saccade_latency", "s", &Parameters::saccade_latency, 0.05, 2, "target step to voluntary saccade",
     "the paper: about 200 ms"},
    {"catch_up_latency", "s", &Parameters::catch_up_latency, 0.02, 2, "decision to catch-up saccade",
     "de Brouwer et al. 2002: 125 ms"},
    {"later_sigma", "1/s", &Parameters::later_sigma, 0, 5,
     "spread of 1/latency (LATER); 0 is deterministic, 1 is human", "Carpenter's LATER model, values from memory"},
    {"saccade_gain", "", &Parameters::saccade_gain, 0.1, 2, "amplitude over error; 0.9 is the human undershoot",
     "Collewijn 1988: 10 % undershoot"},
    {"dead_zone", "rad", &Parameters::dead_zone, 0.001, 0.5, "position error left alone", ours},
    {"smooth_from", "s", &Parameters::smooth_from, 0, 1, "eye-crossing time from which pursuit alone is trusted",
     "de Brouwer et al. 2002: 40 ms"},
    {"smooth_to", "s", &Parameters::smooth_to, 0, 2, "eye-crossing time up to which pursuit alone is trusted",
     "de Brouwer et al. 2002: 180 ms"},
    {"dead_time", "s", &Parameters::dead_time, 0.001, 1, "before a saccade: what is seen later cannot alter it",
     "80-100 ms, Journal of Vision"},
    {"burst_speed", "rad/s", &Parameters::burst_speed, 0.1, 50, "greatest velocity of the burst",
     "Collewijn 1988: 502 deg/s at 40 deg and above"},
    {"burst_angle", "rad", &Parameters::burst_angle, 0.001, 2, "motor error over which the burst saturates", ours},
    {"burst_rise", "s", &Parameters::burst_rise, 0.0001, 0.1, "recruitment of the burst", ours},
    {"burst_lag", "s", &Parameters::burst_lag, 0.001, 0.05, "each of two lags after the burst", ours},
    {"burst_stop", "rad", &Parameters::burst_stop, 0.0001, 0.1, "motor error at which pause cells end the burst", ours},
    {"long_plant_time", "s", &Parameters::long_plant_time, 0.01, 2, "long time constant of the eye plant",
     "Robinson plant, from memory"},
    {"plant_estimate", "", &Parameters::plant_estimate, 0.2, 3,
     "believed over true long plant time; not 1 gives glissades", ours},
    {"integrator_time", "s", &Parameters::integrator_time, 0, 1000,
     "leak of the position integrator; 0 is none, 25 in the dark", "Cannon and Robinson 1985, second hand"},
    {"range", "rad", &Parameters::range, 0.1, 1.2, "oculomotor range of both eyes together",
     "Guitton and Volle 1987: 55 deg mechanical"},
    {"eye_range", "rad", &Parameters::eye_range, 0.1, 1.3, "mechanical range of each eye", "Guitton and Volle 1987"},
    {"listing_tilt", "", &Parameters::listing_tilt, 0, 1,
     "share of vergence by which each Listing plane turns outwards", "Tweed 1998"},
    {"vor_gain", "", &Parameters::vor_gain, 0, 2, "gain of the vestibulo-ocular reflex", "vHIT norms: 0.97"},
    {"vor_latency", "s", &Parameters::vor_latency, 0, 0.2, "latency of the vestibulo-ocular reflex",
     "Collewijn and Smeets 2000: 8.6 ms"},
    {"optokinetic_gain", "1/s", &Parameters::optokinetic_gain, 0, 5,
     "optokinetic velocity gained from slip in fixation", ours},
    {"optokinetic_time", "s", &Parameters::optokinetic_time, 0.1, 100, "decay of optokinetic velocity", ours},
    {"vergence_latency", "s", &Parameters::vergence_latency, 0.001, 1, "disparity to vergence",
     "Rashbass and Westheimer: 160 ms"},
    {"vergence_rate", "1/s", &Parameters::vergence_rate, 0, 50, "slow vergence speed over disparity", ours},
    {"vergence_copy_gain", "", &Parameters::vergence_copy_gain, 0, 2, "efference copy of vergence; 0 is plain feedback",
     ours},
    {"vergence_limit", "rad/s", &Parameters::vergence_limit, 0.001, 5, "speed limit of slow vergence", ours},
    {"vergence_step", "rad", &Parameters::vergence_step, 0.001, 1, "disparity that starts the fast component",
     "steps above about 2 deg/s: Hung, Semmlow and Ciuffreda 1986"},
    {"vergence_burst_speed", "rad/s", &Parameters::vergence_burst_speed, 0, 5, "greatest speed of fast vergence", ours},
    {"vergence_burst_angle", "rad", &Parameters::vergence_burst_angle, 0.001, 2, "disparity over which it saturates",
     ours},
    {"convergence_saccade_rate", "1/s", &Parameters::convergence_saccade_rate, 0, 100, "convergence within a saccade",
     "Collewijn 1995: 40-70 % inside the saccade"},
    {"divergence_saccade_rate", "1/s", &Parameters::divergence_saccade_rate, 0, 100, "divergence within a saccade",
     "Collewijn 1995: 50-100 % inside the saccade"},
    {"head_free", "switch", &Parameters::head_free, 0, 1, "1: the head follows large gaze shifts (simulation only)",
     ours},
    {"head_share", "", &Parameters::head_share, 0, 1, "head share of the eccentricity above the threshold",
     "Freedman and Sparks 1997 (monkey)"},
    {"head_threshold", "rad", &Parameters::head_threshold, 0, 3, "eccentricity below which the head rests",
     "Freedman and Sparks 1997 (monkey)"},
    {"head_time", "s", &Parameters::head_time, 0.05, 5, "duration of a head movement", "assumption"},
    {"drift_speed", "rad/s", &Parameters::drift_speed, 0, 1, "fixation drift, root mean square; 0 is none", ours},
    {"drift_time", "s", &Parameters::drift_time, 0.001, 10, "memory of the drift", ours},
    {"microsaccade_rate", "1/s", &Parameters::microsaccade_rate, 0, 10, "microsaccades; 0 is none, 1.5 is human",
     "1-2 a second"},
    {"microsaccade_size", "rad", &Parameters::microsaccade_size, 0.0001, 0.1, "typical microsaccade", "below 1 deg"},
    {"blink_rate", "1/s", &Parameters::blink_rate, 0, 5, "blinks; 0 is none, 0.25 is human",
     "Sforza 2008: 11-19 a minute"},
    {"blink_closing", "s", &Parameters::blink_closing, 0.01, 2, "closing time of the lid",
     "spontaneous: 15 % below 78 ms"},
    {"blink_opening", "s", &Parameters::blink_opening, 0.01, 2, "opening time of the lid",
     "Sforza 2008: closing 40-47 % faster"},
    {"blink_depth", "", &Parameters::blink_depth, 0, 1, "lid closure of a blink", "Sforza 2008"},
    {"seed", "", &Parameters::seed, 0, 9007199254740992.0, "seed of latency, drift, microsaccades, blinks and noise",
     ""},
    {"eye_distance", "m", &Parameters::eye_distance, 0, 1, "distance between the eyes' centres",
     "population mean 63 mm"},
    {"step", "s", &Parameters::step, 1e-5, 0.02, "internal step; fixed, whatever the frame rate", ours},
});

}  // namespace

std::string_view word(Method method) { return method_words[static_cast<size_t>(method)]; }
std::string_view word(Mode mode) { return mode_words[static_cast<size_t>(mode)]; }

std::optional<Method> method_of(std::string_view text) {
  const auto found = std::find(method_words.begin(), method_words.end(), text);
  if (found == method_words.end()) return std::nullopt;
  return static_cast<Method>(found - method_words.begin());
}

std::span<const Parameter> parameter_table() { return table; }

const Parameter* find_parameter(std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == name; });
  return found == table.end() ? nullptr : &*found;
}

std::optional<std::string> fault(const Parameters& parameters) {
  for (const Parameter& p : table) {
    const double value = parameters.*p.value;
    if (value >= p.low && value <= p.high) continue;
    std::ostringstream sentence;
    sentence << p.name << " must be between " << p.low << " and " << p.high;
    if (!p.unit.empty() && !p.is_switch()) sentence << " " << p.unit;
    sentence << ", not " << value;
    return sentence.str();
  }
  if (parameters.smooth_from > parameters.smooth_to) return "smooth_from must not exceed smooth_to";
  return std::nullopt;
}

int Parameters::steps(double delay) const { return std::max(1, static_cast<int>(std::lround(delay / step))); }

}  // namespace eye
