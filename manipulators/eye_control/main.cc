#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "manipulators/eye_control/chart.h"
#include "manipulators/eye_control/eyes.h"
#include "manipulators/eye_control/simulate.h"
#include "objdb/text.h"
#include "objdb/unit.h"

namespace {

constexpr int bad_data = 1, bad_usage = 2;

struct Options {
  std::string target, head, out, step, chart, frame = "world";
  std::vector<std::string> settings;
};

int complain(int status, const std::string& sentence) {
  std::cerr << sentence << '\n';
  return status;
}

// FIELD=VALUE into the parameters; VALUE may carry a unit
objdb::Status set(eye::Parameters& parameters, const std::string& setting) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos) {
    return objdb::Error{objdb::ErrorKind::syntax, "--set expects FIELD=VALUE, not '" + setting + "'", 0};
  }
  const std::string name = setting.substr(0, equals), value = setting.substr(equals + 1);
  if (name == "method") {
    const auto method = eye::method_of(value);
    if (!method) {
      return objdb::Error{objdb::ErrorKind::range,
                          "method must be one of snap saccade_only linear full, not '" + value + "'", 0};
    }
    parameters.method = *method;
    return {};
  }
  const eye::Parameter* field = eye::find_parameter(name);
  if (!field) {
    std::vector<std::string_view> names{"method"};
    for (const eye::Parameter& p : eye::parameter_table()) names.push_back(p.name);
    return objdb::Error{objdb::ErrorKind::unknown, "no field " + name + objdb::did_you_mean(name, names), 0};
  }
  if (field->is_switch() && (value == "true" || value == "false")) {
    parameters.*field->value = value == "true";
    return {};
  }
  const auto unit = objdb::parse_unit(field->wire_unit());
  auto number = objdb::parse_real(value, unit ? unit->dimension : objdb::Dimension{});
  if (!number) return objdb::Error{number.error().kind, name + ": " + number.error().sentence, 0};
  parameters.*field->value = *number;
  return {};
}

int simulate(const Options& options) {
  constexpr std::string_view columns[] = {"t_s", "azimuth_deg", "elevation_deg"};
  eye::Parameters parameters;
  std::vector<std::string> settings = options.settings;
  if (!options.step.empty()) settings.push_back("step=" + options.step);
  for (const std::string& setting : settings) {
    if (auto status = set(parameters, setting); !status) {
      return complain(bad_usage, "eye_control: error " + std::string(objdb::name_of(status.error().kind)) + " " +
                                     status.error().sentence);
    }
  }
  if (const auto fault = eye::fault(parameters)) return complain(bad_usage, "eye_control: error range " + *fault);

  eye::FollowingWorld world(parameters.eye_distance, parameters.step);
  const auto target = eye::read_table_file(options.target, columns);
  if (!target) return complain(bad_data, target.error().sentence);
  if (auto status = fill_target(world.target_track(), *target, options.target); !status) {
    return complain(bad_data, status.error().sentence);
  }
  if (!options.head.empty()) {
    const auto head = eye::read_table_file(options.head, columns);
    if (!head) return complain(bad_data, head.error().sentence);
    if (auto status = fill_head(world.head_track(), *head, options.head); !status) {
      return complain(bad_data, status.error().sentence);
    }
  }

  std::ofstream file;
  if (options.out != "-") {
    file.open(options.out);
    if (!file) return complain(bad_data, options.out + ": error io the file cannot be written");
  }
  std::ostream& out = options.out == "-" ? std::cout : file;
  eye::write_header(out);
  // one row a millisecond, or a step where that is longer
  const auto every = std::max<int64_t>(1, std::llround(0.001 / parameters.step));
  const eye::Frame frame = options.frame == "head" ? eye::Frame::head : eye::Frame::world;
  simulate(world, std::make_shared<eye::Parameters>(parameters), frame,
           [&](const eye::TraceRow& row, const eye::Gaze& gaze) {
             if (gaze.step() % every == 0) write_row(out, row);
           });
  out.flush();
  return out ? 0 : complain(bad_data, options.out + ": error io the file cannot be written to its end");
}

// the parameters as a table, for the documentation and for people
int list_parameters() {
  const eye::Parameters defaults;
  std::cout << "| parameter | unit | default | from | to | what it is | source |\n|---|---|---|---|---|---|---|\n";
  for (const eye::Parameter& p : eye::parameter_table()) {
    std::cout << "| `" << p.name << "` | " << p.unit;
    for (double number : {defaults.*p.value, p.low, p.high}) std::cout << " | " << number;
    std::cout << " | " << p.doc << " | " << p.source << " |\n";
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "eye_control: both eyes of a figure: saccades, pursuit, vergence and reflexes.\n"
      "Without options it is a manipulator.");
  Options options;
  app.add_option("--simulate", options.target, "run the eyes over a target's course (CSV) without a dialog manager");
  app.add_option("--head", options.head, "the head's course (CSV)");
  app.add_option("--set", options.settings, "FIELD=VALUE, a parameter of the model; may be repeated");
  app.add_option("--step", options.step, "internal step (1ms)");
  app.add_option("--frame", options.frame, "directions of the trace: in the world, or of the eyes in the head")
      ->check(CLI::IsMember({"world", "head"}));
  app.add_option("--out", options.out, "the trace (CSV); - is standard output");
  app.add_option("--chart", options.chart, "measure what docs/charts shows and write it into this folder (CSV)");
  bool parameters = false;
  app.add_flag("--parameters", parameters, "list the parameters: units, defaults, bounds and sources");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : bad_usage;
  }
  if (parameters) return list_parameters();
  if (!options.chart.empty()) {
    const auto written = eye::write_charts(options.chart);
    return written ? 0 : complain(bad_data, written.error().sentence);
  }
  if (!options.target.empty()) {
    if (options.out.empty()) return complain(bad_usage, "eye_control: error syntax --simulate needs --out TRACE.csv");
    return simulate(options);
  }
  if (argc > 1) return complain(bad_usage, "eye_control: error syntax expected --simulate or --chart, see --help");
  return eye::Eyes().run();
}
