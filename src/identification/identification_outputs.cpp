#include <breakwater/identification/identification_outputs.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/identification/axis_model.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/identification/identified_plants.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/recorded/recorded_estimation.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

nlohmann::ordered_json errors_json(const FitErrors& errors) {
  return {{"rms_rad", errors.rms}, {"normalised", errors.normalised}};
}

double time_step_of(const AxisData& data) {
  double step_s = 0.0;
  for (const AxisStretch& stretch : data.stretches) step_s = std::max(step_s, stretch.time_step_s);
  return step_s;
}

// Each parameter's value, interval and identifiability, and "fit" with the errors, the whiteness
// and the notes.
std::string identified_json(const Identification& identification) {
  nlohmann::ordered_json json;
  const AxisParameter known = identification.data.model->known_inertia;
  if (!identification.free[known]) {
    const double inertia = identification.fit.values[known];
    json[parameter_key(known)] = {{"value", inertia},
                                  {"low", inertia},
                                  {"high", inertia},
                                  {"identifiable", true},
                                  {"given", true}};
  }
  for (const ParameterEstimate& estimate : identification.parameters) {
    nlohmann::ordered_json& entry = json[parameter_key(estimate.parameter)];
    entry = {{"value", estimate.value},
             {"low", estimate.low},
             {"high", estimate.high},
             {"identifiable", estimate.is_identifiable}};
    if (!estimate.is_identifiable) {
      entry["reason"] = estimate.reason;
      entry["excitation"] = estimate.excitation;
    }
    if (!identification.whiteness.is_white()) entry["too_narrow"] = true;
  }
  nlohmann::ordered_json& fit = json["fit"];
  fit["converged"] = identification.is_converged;
  fit["interval"] = identification.is_bootstrapped ? "parametric bootstrap" : "profile likelihood";
  fit["rows"] = identification.data.rows();
  fit["stretches"] = identification.data.stretches.size();
  fit["period_s"] = identification.data.period_s;
  fit["time_step_s"] = time_step_of(identification.data);
  fit["quantum_rad"] = identification.data.quantum;
  fit["quantum_found"] = identification.is_quantum_found;
  fit["noise_std_rad"] = identification.fit.noise_std;
  fit["errors"] = errors_json(identification.errors);
  fit["white"] = identification.whiteness.is_white();
  fit["ljung_box"] = identification.whiteness.statistic;
  fit["ljung_box_limit"] = identification.whiteness.limit;
  if (identification.held_out) {
    fit["held_out"] = errors_json(*identification.held_out);
    fit["holds"] = identification.holds();
  }
  fit["notes"] = identification.notes;
  return json.dump(2) + "\n";
}

std::string identified_toml(const Catalogue& catalogue, const IdentifiedKeys& scenario,
                            const IdentifiedNumbers& numbers) {
  const auto file = catalogue.get<ScenarioKind>(scenario.scenario).scenario_file();
  return prepare_run(catalogue, scenario.scenario, *file, scenario.case_name,
                     scenario.sets(numbers))
      .config_text;
}

std::string unknown_text(const ParameterEstimate& estimate) {
  return estimate.reason + ". This would help: " + estimate.excitation;
}

std::string left_out_of_two_inertia(const Identification& identification) {
  const double offset = identification.fit.values[kOffset];
  if (offset == 0.0) return "";
  return fmt::format("# Left out, since this scenario has no constant torque: offset {:.6g} N m\n",
                     offset);
}

PageData parameters(const Identification& identification) {
  auto rows = PageData::array();
  for (const ParameterEstimate& estimate : identification.parameters) {
    // The ends of a narrow interval differ in their last digits.
    const auto shown = [&estimate](double value) {
      return estimate.is_identifiable ? fmt::format("{:.7g}", value) : "-";
    };
    PageData answer = {{"value", !estimate.is_identifiable ? "no"
                                 : identification.whiteness.is_white()
                                     ? "yes"
                                     : "yes, interval too narrow"}};
    if (!estimate.is_identifiable) {
      answer["lines"].push_back({{"text", unknown_text(estimate)}, {"kind", "spread"}});
    }
    rows.push_back(PageData::array({parameter_key(estimate.parameter), shown(estimate.value),
                                    shown(estimate.low), shown(estimate.high),
                                    known_parameter(estimate.parameter).unit, answer}));
  }
  return {{"label", "Parameters"},
          {"columns", {"parameter", "value", "low", "high", "unit", "identifiable"}},
          {"rows", rows}};
}

PageData errors(const Identification& identification) {
  auto rows = PageData::array();
  const auto add = [&](const char* name, const FitErrors& of) {
    rows.push_back(PageData::array({name, of.rms, of.normalised}));
  };
  add("records of the fit", identification.errors);
  if (identification.held_out) add("held-out records", *identification.held_out);
  return {{"label", "Errors"},
          {"columns", PageData::array({"", "RMS error [rad]", "relative to what is explained"})},
          {"rows", rows}};
}

PageData fit_figures(const Identification& identification) {
  auto figures = PageData::array();
  const AxisData& data = identification.data;
  const std::vector<double> positions = fitted_positions(data, identification.fit);
  auto next = positions.begin();
  for (const AxisStretch& stretch : data.stretches) {
    const auto first = std::exchange(next, next + std::ssize(stretch.times_s));
    const std::vector<double> fitted(first, next);
    std::vector<double> residuals;
    std::ranges::transform(stretch.positions, fitted, std::back_inserter(residuals),
                           std::minus<>());
    const auto line = [&](const char* label, const std::vector<double>& values, LineStyle look) {
      return ChartSeries{
          .label = label, .unit = "rad", .values = {stretch.times_s, values}, .style = look};
    };
    const std::string number = std::to_string(&stretch - data.stretches.data() + 1);
    const std::string which = data.stretches.size() > 1 ? ", stretch " + number : "";
    PageChart position{.id = "position-" + number, .group = "stretch-" + number};
    PageChart residual{.id = "residuals-" + number, .group = position.group, .title = "residual"};
    position.title = "position";
    position.series = {line("measured", stretch.positions, 0), line("fitted", fitted, 1)};
    residual.series = {line("residual", residuals, 0)};
    residual.lines = {-data.quantum, data.quantum};
    figures.push_back(figure_of(position, "Position" + which, "Measured, and the fit above it."));
    figures.push_back(figure_of(residual, "Residuals" + which,
                                "Measured minus fitted. The dashed lines are one count."));
  }
  return figures;
}

// Sentences that a user must know before the numbers.
std::vector<std::string> findings_of(const Identification& identification) {
  std::vector<std::string> findings;
  if (!identification.is_converged) {
    findings.emplace_back("the fit did not converge: the values are not to be used");
  }
  if (!identification.holds()) {
    findings.push_back(
        fmt::format("the held-out records disagree: their errors are {:.3g} times those that "
                    "noise, encoder and uncertainty explain (at most 2)",
                    identification.held_out->normalised));
  }
  return findings;
}

PageData identification_result(const Identification& identification,
                               const std::vector<std::string>& warnings,
                               const std::string& command) {
  const bool is_axis = identification.data.model == &friction_axis();
  PageData lead = {
      {{"text", fmt::format("Inertia, friction and delay of one axis from recorded data. {} rows; "
                            "one count is {:.6g} rad, and the noise before the encoder is {:.6g} "
                            "rad.",
                            identification.data.rows(), identification.data.quantum,
                            identification.fit.noise_std)}}};
  std::string explained = "Noise, encoder and the intervals explain an error of 1.";
  if (identification.held_out) {
    explained += identification.holds() ? " The held-out records agree: their error is at most 2."
                                        : " The held-out records disagree: their error is above 2.";
  }
  const auto find = [&](const std::string& text) { lead.push_back(PageData{{"finding", text}}); };
  for (const std::string& text : findings_of(identification)) find(text);
  for (const std::string& text : identification.notes) find(text);
  for (const std::string& text : warnings) find(text);
  lead.push_back(PageData{{"command", command}});
  auto sections = PageData::array();
  add_section(sections, "parameters", "Parameters",
              {{{"table", parameters(identification)}},
               {{"text", fmt::format("From low to high: 95 %, by {}.",
                                     identification.is_bootstrapped ? "parametric bootstrap"
                                                                    : "profile likelihood")}}});
  add_section(
      sections, "errors", "Errors",
      {{{"table", errors(identification)}},
       {{"text", explained}},
       {{"text", fmt::format("Ljung and Box of the residuals: {:.4g}, limit {:.4g}: {}.",
                             identification.whiteness.statistic, identification.whiteness.limit,
                             identification.whiteness.is_white() ? "white" : "not white")}}});
  add_section(sections, "fit", "Fit and residuals",
              PageData::array({{{"figures", fit_figures(identification)}}}));
  return {{"title", is_axis ? "Identification of an axis" : "Identification of a motor and a load"},
          {"lead", lead},
          {"sections", sections}};
}

namespace fs = std::filesystem;

constexpr const char* kIdentify = "identify";
constexpr const char* kTwoInertia = "two_inertia";

struct IdentifyArguments {
  std::vector<std::string> files;
  std::vector<std::string> held_out;
  std::string model = "axis";
  std::string friction = "coulomb";
  std::optional<double> inertia;
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
  double quantum = -1.0;
  EncoderRounding rounding = EncoderRounding::nearest;
  Side side = Side::motor;

  Fields fields() {
    Fields fields;
    bind_record_format(fields, format);
    fields.optional_number(
        "encoder.quantum", quantum, any(),
        "encoder resolution, one count; 0: not quantised; negative: found [rad]");
    bind_encoder_rounding(fields, rounding);
    fields.optional_choice("encoder.side", side, {{"motor", Side::motor}, {"load", Side::load}},
                           "side with the encoder, for --model two_inertia");
    return fields;
  }
};

Keys keys_of(const std::vector<std::string>& assignments) {
  Keys keys;
  Config sets("--set", {});
  for (const std::string& assignment : assignments) sets.set(assignment);
  keys.fields().read(sets);
  check_record_format(sets);
  return keys;
}

// estimate.toml, a file of `breakwater estimate` with the first table, plant, encoder and noise.
std::string estimate_toml(const Catalogue& catalogue, const Identification& identification,
                          const IdentifyArguments& arguments, const RecordFormat& format) {
  const IdentifiedNumbers plant = identified_plant(identification);
  const auto file = recorded_estimation().scenario_file();
  std::vector<std::string> sets = arguments.sets;
  std::erase_if(sets, [](const std::string& one) { return one.starts_with("encoder.side="); });
  sets.push_back("csv.file=" + toml_string(arguments.files.front()));
  const auto set = [&](const char* key, double value) {
    sets.push_back(fmt::format("{}={:.12g}", key, value));
  };
  set("csv.time_std_s", time_step_of(identification.data) / std::sqrt(12.0));
  set("csv.input_scale", format.input_scale * identification.fit.values[kTorqueConstant]);
  set("plant.inertia", plant.at(parameter_key(kInertia)));
  set("plant.viscous_friction", plant.at(parameter_key(kViscous)));
  set("encoder.quantum", plant.at("quantum"));
  set("noise.std", plant.at("noise_std"));
  RecordedEstimation estimation(catalogue);
  Fields fields = estimation.fields();
  fields.read(file->config(file->default_case(), sets));
  return fields.print("estimate", file->default_case());
}

std::vector<RecordedAxis> records_of(const std::vector<std::string>& files, const Keys& keys,
                                     std::vector<std::string>& warnings) {
  std::vector<RecordedAxis> records;
  for (const std::string& file : files) {
    records.push_back(read_recorded_axis(file, keys.format));
    for (std::string& line : records.back().warnings(file)) warnings.push_back(std::move(line));
  }
  return records;
}

// A table that counts twice makes the intervals too narrow, and agrees with itself.
void check_different(std::vector<std::string> files, const std::vector<std::string>& others) {
  files.insert(files.end(), others.begin(), others.end());
  for (auto file = files.begin(); file != files.end(); ++file) {
    const auto is_same = [&](const std::string& other) {
      std::error_code none;
      return other == *file || fs::equivalent(other, *file, none);
    };
    if (std::any_of(files.begin(), file, is_same)) refuse(*file + " is there twice");
  }
}

int identify(const Catalogue& catalogue, const IdentifyArguments& arguments,
             const std::string& command) {
  check_different(arguments.files, arguments.held_out);
  RunFolder folder(arguments.out);
  const Keys keys = keys_of(arguments.sets);
  const bool has_two = arguments.model == kTwoInertia;
  if (!has_two && keys.side == Side::load) refuse("encoder.side: load needs --model two_inertia");
  std::vector<std::string> warnings;
  const std::vector<RecordedAxis> records = records_of(arguments.files, keys, warnings);
  const std::vector<RecordedAxis> held_out = records_of(arguments.held_out, keys, warnings);
  warn(kIdentify, warnings);
  IdentificationSettings settings;
  settings.has_stribeck = arguments.friction == "stribeck";
  settings.inputs_act_before = keys.format.input_acts == InputActs::before;
  if (keys.quantum >= 0.0) settings.quantum = keys.quantum;
  settings.rounding = keys.rounding;
  settings.known_inertia = arguments.inertia;
  if (has_two) settings.model = &two_inertia_axis(keys.side);
  std::optional<Progress> line(std::in_place, kIdentify, std::vector{1.0}, arguments.quiet);
  settings.progress = [&](double share) { line->update(0, share); };
  const Identification result = [&] {
    try {
      return identify_despite_clocks(records, held_out, settings);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(
          fmt::format("{}: {}", fmt::join(arguments.files, ", "), error.what()));
    }
  }();
  line.reset();
  if (result.parameters.empty()) {
    warn(kIdentify, {"the fit found no likelihood: check the columns, their units and signs"});
    return kRunFailed;
  }
  const fs::path& out = folder.path();
  write_text_file(out / "identified.json", identified_json(result));
  const IdentifiedKeys scenario = identified_keys(catalogue, arguments.model);
  if (!scenario.scenario.empty()) {
    write_text_file(out / "identified.toml",
                    (has_two ? left_out_of_two_inertia(result) : "") +
                        identified_toml(catalogue, scenario, identified_plant(result)));
  }
  if (!has_two && !scenario.scenario.empty()) {
    write_text_file(out / "estimate.toml",
                    estimate_toml(catalogue, result, arguments, keys.format));
    write_text_file(out / "draws.csv", drawn_csv(result, scenario));
  }
  write_text_file(out / "report.html",
                  html_page("identification", identification_result(result, warnings, command)));
  folder.commit();
  std::vector<std::string> notes = result.notes;
  for (const ParameterEstimate& estimate : result.parameters) {
    if (estimate.is_identifiable) continue;
    notes.push_back(fmt::format("{} is not identifiable: {}", parameter_key(estimate.parameter),
                                unknown_text(estimate)));
  }
  // A forgotten scale is one cause. Its consequences would hide it.
  const bool is_doubtful = std::any_of(records.begin(), records.end(),
                                       [](const RecordedAxis& one) { return !one.doubts.empty(); });
  if (!arguments.quiet) {
    if (!is_doubtful) warn(kIdentify, notes);
    fmt::print("results: {}\n\n{}", arguments.out,
               printed_table(parameters(result), output_width()));
  }
  const std::vector<std::string> findings = findings_of(result);
  warn(kIdentify, findings);
  return findings.empty() ? kSuccess : kRunFailed;
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
        ->check(must_be_positive);
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
        "With --model axis it also gets draws.csv (draws of the plant, for a study) and "
        "estimate.toml\n"
        "(for estimate on the table).\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 3 the fit did not converge or the "
        "held-out tables disagree.");
    if (const auto status = parse(app, argc, argv)) return *status;
    if (arguments.model == kTwoInertia && arguments.friction == "stribeck") {
      refuse("--friction: stribeck needs --model axis");
    }
    if (arguments.files.empty()) refuse("FILE is missing: a recorded table");
    std::string command = program;
    for (int i = 1; i < argc; ++i) command += " " + shell_word(argv[i]);
    return identify(catalogue, arguments, command);
  });
}

}  // namespace

CommandKind identify_command() {
  return {kIdentify,
          "fit inertias, friction and delay of a plant to recorded data: identify FILE...",
          identify_main};
}

}  // namespace breakwater
