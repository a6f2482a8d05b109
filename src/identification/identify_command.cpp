#include <breakwater/identification/identify_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include <breakwater/experiment/settings.h>
#include <breakwater/identification/axis_parameters.h>
#include <breakwater/identification/clock_offset.h>
#include <breakwater/identification/identification_outputs.h>
#include <breakwater/identification/identification_report.h>
#include <breakwater/identification/identified_study.h>
#include <breakwater/identification/two_inertia_axis.h>
#include <breakwater/identification/two_inertia_outputs.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>
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
constexpr const char* kTwoInertia = "two_inertia";

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

[[noreturn]] void refuse(const std::string& reason) {
  throw std::invalid_argument(fmt::format("{} {}: {}", own_program_name(), kIdentify, reason));
}

// The keys of `estimate` that describe the table and the encoder.
struct Keys {
  RecordFormat format;
  InputActs input_acts = InputActs::after;
  double quantum = -1.0;
  EncoderRounding rounding = EncoderRounding::nearest;
  Side side = Side::motor;

  Fields fields() {
    Fields fields;
    bind_record_format(fields, format, input_acts);
    fields.number("encoder.quantum", quantum, any(),
                  "encoder resolution, one count; 0: not quantised; negative: found [rad]");
    bind_encoder_rounding(fields, rounding);
    fields.choice("encoder.side", side, {{"motor", Side::motor}, {"load", Side::load}},
                  "side with the encoder, for --model two_inertia");
    fields.standard("encoder.side", {std::string("motor")});
    fields.standard("csv.input_scale", {1.0});
    fields.standard("csv.position_scale", {1.0});
    fields.standard("csv.input_acts", {std::string("after")});
    fields.standard("encoder.quantum", {-1.0});
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

std::vector<RecordedAxis> records_of(const std::vector<std::string>& files, const Keys& keys,
                                     std::vector<std::string>& warnings) {
  std::vector<RecordedAxis> records;
  for (const std::string& file : files) {
    records.push_back(read_recorded_axis(file, keys.format));
    const RecordedAxis& record = records.back();
    if (!record.repairs.empty()) {
      warnings.push_back(fmt::format("{}: repaired: {}", file, fmt::join(record.repairs, "; ")));
    }
    for (const std::string& doubt : record.doubts) {
      warnings.push_back(fmt::format("{}: {}", file, doubt));
    }
  }
  return records;
}

int identify(const Catalogue& catalogue, const IdentifyArguments& arguments,
             const std::string& command) {
  RunFolder folder(arguments.out);
  const Keys keys = keys_of(arguments);
  const bool has_two = arguments.model == kTwoInertia;
  if (!has_two && keys.side == Side::load) refuse("encoder.side: load needs --model two_inertia");
  std::vector<std::string> warnings;
  const std::vector<RecordedAxis> records = records_of(arguments.files, keys, warnings);
  const std::vector<RecordedAxis> held_out = records_of(arguments.held_out, keys, warnings);
  warn(kIdentify, warnings);
  IdentificationSettings settings;
  settings.has_stribeck = arguments.friction == "stribeck";
  settings.inputs_act_before = keys.input_acts == InputActs::before;
  if (keys.quantum >= 0.0) settings.quantum = keys.quantum;
  settings.rounding = keys.rounding;
  settings.known_inertia = arguments.inertia;
  if (has_two) settings.model = &two_inertia_axis(keys.side);
  const Identification result = identify_despite_clocks(records, held_out, settings);
  if (result.parameters.empty()) {
    warn(kIdentify, {"the fit found no likelihood: check the columns, their units and signs"});
    return kRunFailed;
  }
  const fs::path& out = folder.path();
  write_text_file(out / "identified.json", identified_json(result));
  const auto& scenarios = catalogue.all<IdentifiedScenarioKind>();
  const auto& two_inertias = catalogue.all<IdentifiedTwoInertiaKind>();
  if (has_two && !two_inertias.empty()) {
    write_text_file(out / "identified.toml",
                    two_inertia_toml(catalogue, result, two_inertias.front(), keys.side));
  } else if (!has_two && !scenarios.empty()) {
    write_text_file(out / "identified.toml", identified_toml(catalogue, result, scenarios.front()));
    write_text_file(out / "estimate.toml", estimate_toml(catalogue, result,
                                                         {arguments.files.front(), arguments.config,
                                                          keys.format, keys.input_acts}));
    write_text_file(out / "sweep.toml", identified_sweep(result, scenarios.front()));
    write_text_file(out / "tune.toml", identified_tuning(result, scenarios.front()));
  }
  write_text_file(out / "report.html",
                  html_page("identification", identification_result(result, warnings, command)));
  folder.commit();
  std::vector<std::string> notes = result.notes;
  for (const ParameterEstimate& estimate : result.parameters) {
    if (has_two && estimate.parameter == kOffset && estimate.low * estimate.high > 0.0) {
      notes.push_back(fmt::format("identified.toml leaves out {}: its scenario has none",
                                  parameter_key(kOffset)));
    }
    if (estimate.is_identifiable) continue;
    notes.push_back(fmt::format("{} is not identifiable: {}. This would help: {}",
                                parameter_key(estimate.parameter), estimate.reason,
                                estimate.excitation));
  }
  // A forgotten scale is one cause. Its consequences would hide it.
  const bool is_doubtful = std::any_of(records.begin(), records.end(),
                                       [](const RecordedAxis& one) { return !one.doubts.empty(); });
  if (!arguments.quiet) {
    if (!is_doubtful) warn(kIdentify, notes);
    fmt::print("results: {}\n\n{}", arguments.out, parameter_table(result, output_width()));
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
    CLI::App app(
        "Fits the model of an axis, or of a motor and a load, to recorded data, with intervals.",
        program);
    IdentifyArguments arguments;
    app.add_option("FILE", arguments.files, "tables with the columns time_s, u and y");
    app.add_option("--holdout", arguments.held_out,
                   "check the fit on these tables, which it does not use")
        ->type_name("FILE");
    app.add_option("--model", arguments.model,
                   "the plant: axis, or two_inertia: a motor and a load with a spring")
        ->check(CLI::IsMember({"axis", kTwoInertia}))
        ->capture_default_str();
    app.add_option("--friction", arguments.friction,
                   "friction: coulomb (and viscous), or with stribeck")
        ->check(CLI::IsMember({"coulomb", "stribeck"}))
        ->capture_default_str();
    app.add_option("--inertia", arguments.inertia,
                   "take this inertia [kg m^2], with two_inertia the motor's, as known, and fit "
                   "the torque\n"
                   "constant instead")
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
        "The folder gets identified.json, identified.toml (a scenario file of this plant) and "
        "report.html.\n"
        "With --model axis it also gets sweep.toml and tune.toml (studies over its uncertainty), "
        "and\n"
        "estimate.toml (for estimate on the table).\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 3 the fit did not converge or the "
        "held-out tables disagree.");
    if (const auto status = parse(app, argc, argv)) return *status;
    if (arguments.model == kTwoInertia && arguments.friction == "stribeck") {
      refuse("--friction: stribeck needs --model axis");
    }
    if (arguments.files.empty()) refuse("FILE is missing: a recorded table");
    const std::vector<std::string> words(argv + 1, argv + argc);
    return identify(catalogue, arguments, fmt::format("{} {}", program, fmt::join(words, " ")));
  });
}

}  // namespace

CommandKind identify_command() {
  return {kIdentify,
          "fit inertias, friction and delay of a plant to recorded data: identify FILE...",
          identify_main};
}

}  // namespace breakwater
