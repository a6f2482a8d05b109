#include <breakwater/identification/identify_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <stdexcept>

#include <breakwater/experiment/settings.h>
#include <breakwater/identification/identification_outputs.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/recorded/record_keys.h>
#include <breakwater/recorded/recorded_estimation.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kIdentify = "identify";

struct IdentifyArguments {
  std::vector<std::string> files;
  std::vector<std::string> held_out;
  std::string model = "axis";
  std::string friction = "coulomb";
  std::optional<double> inertia;
  std::string config;
  std::vector<std::string> sets;
  std::string out = "runs/identify";
  bool quiet = false;
};

// The keys of `estimate` that describe the table and the encoder.
struct Keys {
  RecordFormat format;
  InputActs input_acts = InputActs::after;
  double quantum = -1.0;
  EncoderRounding rounding = EncoderRounding::nearest;

  Fields fields() {
    Fields fields;
    bind_record_format(fields, format, input_acts);
    fields.number("encoder.quantum", quantum, any(),
                  "encoder resolution, one count; 0: not quantised; negative: found [rad]");
    bind_encoder_rounding(fields, "encoder.rounding", rounding);
    fields.standard("csv.input_scale", {1.0});
    fields.standard("csv.position_scale", {1.0});
    fields.standard("csv.input_acts", {std::string("after")});
    fields.standard("encoder.quantum", {-1.0});
    fields.standard("encoder.rounding", {std::string("nearest")});
    return fields;
  }
};

Keys keys_of(const IdentifyArguments& arguments) {
  Keys keys;
  Config sets(arguments.config.empty() ? "--set" : arguments.config, {});
  for (const std::string& assignment : arguments.sets) sets.set(assignment);
  keys.fields().read(sets);
  check_record_format(sets);
  if (!arguments.config.empty()) {
    // A file of `estimate` has further keys.
    const ScenarioFile file(arguments.config, "estimate");
    const Config config = file.config(file.default_case(), arguments.sets);
    keys.fields().read_finished(config);
    check_record_format(config);
  }
  return keys;
}

std::vector<RecordedAxis> records_of(const std::vector<std::string>& files, const Keys& keys) {
  std::vector<RecordedAxis> records;
  for (const std::string& file : files) {
    records.push_back(read_recorded_axis(file, keys.format));
    if (!records.back().repairs.empty()) {
      warn(kIdentify,
           {fmt::format("{}: repaired: {}", file, fmt::join(records.back().repairs, "; "))});
    }
  }
  return records;
}

int identify(const Catalogue& catalogue, const IdentifyArguments& arguments) {
  const Keys keys = keys_of(arguments);
  const std::vector<RecordedAxis> records = records_of(arguments.files, keys);
  const std::vector<RecordedAxis> held_out = records_of(arguments.held_out, keys);
  IdentificationSettings settings;
  settings.has_stribeck = arguments.friction == "stribeck";
  settings.inputs_act_before = keys.input_acts == InputActs::before;
  if (keys.quantum >= 0.0) settings.quantum = keys.quantum;
  settings.rounding = keys.rounding;
  settings.known_inertia = arguments.inertia;
  const Identification result = identify_axis(records, held_out, settings);
  const fs::path out = arguments.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw OutputError(out.string() + ": " + error.message());
  replace_file(out / "identified.json", identified_json(result));
  const auto& scenarios = catalogue.all<IdentifiedScenarioKind>();
  if (!scenarios.empty()) {
    replace_file(out / "identified.toml", identified_toml(catalogue, result, scenarios.front()));
  }
  std::vector<std::string> notes = result.notes;
  for (const ParameterEstimate& estimate : result.parameters) {
    if (estimate.is_identifiable) continue;
    notes.push_back(fmt::format("{} is not identifiable: {}. This would help: {}",
                                parameter_key(estimate.parameter), estimate.reason,
                                estimate.excitation));
  }
  if (!arguments.quiet) {
    warn(kIdentify, notes);
    fmt::print("results: {}\n\n{}", out.string(), parameter_table(result, output_width()));
  }
  if (!result.is_converged) {
    warn(kIdentify, {"the fit did not converge: the values are not to be used"});
    return kRunFailed;
  }
  if (!result.holds()) {
    warn(kIdentify,
         {fmt::format("the held-out records disagree: their errors are {:.3g} times those that "
                      "noise, encoder and uncertainty explain (at most 2)",
                      result.held_out->normalised)});
    return kRunFailed;
  }
  return kSuccess;
}

int identify_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " " + kIdentify;
  return guarded(program, [&] {
    CLI::App app("Fits the model of an axis to recorded data, with intervals.", program);
    IdentifyArguments arguments;
    app.add_option("FILE", arguments.files, "tables with the columns time_s, u and y")->required();
    app.add_option("--holdout", arguments.held_out,
                   "check the fit on these tables, which it does not use")
        ->type_name("FILE");
    app.add_option("--model", arguments.model, "the plant: axis")
        ->check(CLI::IsMember({"axis"}))
        ->capture_default_str();
    app.add_option("--friction", arguments.friction,
                   "friction: coulomb (and viscous), or with stribeck")
        ->check(CLI::IsMember({"coulomb", "stribeck"}))
        ->capture_default_str();
    app.add_option("--inertia", arguments.inertia,
                   "take this inertia [kg m^2] as known, and fit the torque constant instead")
        ->check(CLI::PositiveNumber);
    app.add_option("--config", arguments.config,
                   "read the keys of table and encoder from this file of estimate")
        ->type_name("FILE");
    app.add_option("--set", arguments.sets,
                   "set csv.time_scale, csv.input_scale, encoder.quantum, ... as in estimate")
        ->type_name("KEY=VALUE");
    app.add_option("--out", arguments.out, "write the results to this folder")
        ->type_name("DIR")
        ->capture_default_str();
    app.add_flag("--quiet", arguments.quiet, "print errors only");
    app.footer(
        "The folder gets identified.json and identified.toml, a scenario file of this axis.\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 3 the fit did not converge or the "
        "held-out tables disagree.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return identify(catalogue, arguments);
  });
}

}  // namespace

CommandKind identify_command() {
  return {kIdentify,
          "fit inertia, friction and delay of an axis to recorded data: identify FILE...",
          identify_main};
}

}  // namespace breakwater
