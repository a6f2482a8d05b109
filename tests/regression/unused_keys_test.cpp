// Keys reported as ineffective have no effect, and no shipped case sets one.
#include <fmt/format.h>

#include <breakwater/experiment/runner.h>
#include <breakwater/shell/all_cores.h>
#include "catalogue.h"

namespace breakwater::unused_keys_test {
namespace {

TEST(UnusedKeys, NoShippedCaseSetsOne) {
  for (const std::string& name : testing::scenario_names()) {
    const ScenarioFile file = testing::scenario_file(name);
    for (const std::string& case_name : file.cases()) {
      for (const IneffectiveKey& ineffective : testing::prepare(name, case_name).ineffective) {
        ADD_FAILURE() << name << " " << case_name << ": " << ineffective.origin << ": "
                      << ineffective.key;
      }
    }
  }
}

// Another option of a choice.
std::string other_option(const std::string& key, const std::string& now) {
  static const std::map<std::string, std::vector<std::string>> options = {
      {"controller.gains", {"retuned", "dlqr"}},
      {"controller.name", {"pd", "none"}},
      {"controller.positioning", {"joint", "workspace"}},
      {"controller.ik_form", {"printed", "sugihara"}},
      {"controller.cancel_at", {"sample", "decision"}},
      {"controller.disturbance_use", {"none", "predict", "cancel"}},
      {"controller.last_weight", {"factor", "riccati"}},
      {"encoder.origin", {"counted", "calibrated"}},
      {"encoder.rounding", {"nearest", "truncate"}},
      {"encoder.side", {"load", "motor"}},
      {"friction.side", {"load", "motor"}},
      {"estimator.process_noise", {"printed", "tuned"}},
      {"estimator.process_noise_mode", {"per_step", "delta"}},
      {"estimator.process_noise_states", {"all", "highest"}},
      {"estimator.wave_force", {"given", "estimated"}},
      {"estimator.wave_frequency", {"given", "estimated"}},
      {"nominal.model", {"rigid", "motor"}},
      {"observer.likelihood", {"gauss", "code"}},
      {"observer.name", {"idob", "none"}},
      {"sensor.encoder_side", {"load", "motor"}},
      {"observer.covariance_form", {"symmetric", "printed"}},
      {"observer.process_noise_on", {"input", "all"}},
      {"solver.name", {"active_set", "hildreth"}},
      {"solver.on_infeasible", {"soften", "stop"}},
      {"solver.soften_first", {"position", "velocity"}}};
  // "axis.NAME.observer.name" is an axis' "observer.name".
  const std::size_t axis_ends = key.starts_with("axis.") ? key.find('.', 5) + 1 : 0;
  for (const std::string& option : options.at(key.substr(axis_ends))) {
    if (option != now) return option;
  }
  return "";
}

// A similar legal value.
std::string other_value(const std::string& key, const ConfigValue& value) {
  // γ must be at least 1, and periods are multiples of each other.
  const double factor = key.find("gamma") != std::string::npos ? 1.1
                        : key.ends_with("period_s")            ? 2.0
                                                               : 0.9;
  if (const auto* real = std::get_if<double>(&value.data)) {
    return fmt::format("{}", *real == 0.0 ? 0.01 : *real * factor);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) {
    return fmt::format("{}", *whole > 1 ? *whole - 1 : *whole + 1);
  }
  if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "false" : "true";
  if (const auto* text = std::get_if<std::string>(&value.data)) {
    return '"' + other_option(key, *text) + '"';
  }
  std::string list;
  for (const ConfigValue& element : std::get<ConfigValue::Array>(value.data)) {
    list += (list.empty() ? "" : ", ") + other_value(key, element);
  }
  return "[" + list + "]";
}

struct Trial {
  std::string scenario;
  std::string case_name;
  std::vector<std::string> sets;
};

// Every shipped case, shortened, and keys that no case has.
std::vector<Trial> all_trials() {
  const std::map<std::string, std::vector<std::string>> brief = {
      {"arm_push", {"run.duration_s=1", "push.start_s=0.2", "push.rise_s=0.3"}},
      {"arm_wall_contact",
       {"run.duration_s=6", "wall.solid_from_s=4", "force.from_s=4.5", "metrics.from_s=5"}},
      {"cart_constrained", {"run.duration_s=4.5", "disturbance.start_s=1"}},
      {"cart_estimation", {"run.duration_s=30"}},
      {"cart_offset_free", {"run.duration_s=3"}},
      {"cart_position", {"run.duration_s=1"}},
      {"impact_test", {"run.duration_s=0.1"}},
      {"motor_estimation", {"run.duration_s=2"}},
      {"plant", {"run.duration_s=1"}},
      {"quadrotor_waves", {"run.duration_s=2", "metrics.window_s=1"}},
      {"two_inertia", {"run.duration_s=0.3"}}};
  const std::map<std::string, std::vector<std::vector<std::string>>> more = {
      {"arm_push", {{"controller.positioning=workspace"}}},
      {"cart_constrained", {{"condition=A"}, {"condition=E", "controller.name=lqr"}}},
      {"cart_estimation",
       {{"disturbance.kind=ramp"},
        {"disturbance.kind=sine", "observer.name=vfakfd"},
        {"disturbance.kind=high_sine", "observer.name=qvff"}}},
      {"cart_offset_free", {{"noise.enabled=true"}, {"noise.enabled=false"}}},
      {"cart_position",
       {{"observer.name=vfakfd"},
        {"observer.name=stf"},
        {"encoder.resolution_m=0", "controller.name=mpc", "solver.name=hildreth"},
        {"controller.name=mpc", "controller.disturbance_use=predict",
         "solver.on_infeasible=stop"}}},
      {"motor_estimation",
       {{"disturbance.kind=none"},
        {"disturbance.kind=sine"},
        {"disturbance.kind=two_sines"},
        {"disturbance.kind=chirp"},
        {"encoder.bits=0", "observer.alpha=1"},
        {"observer.name=state_observer", "observer.poles_rad_s=[-10, -20]"}}},
      {"quadrotor_waves",
       {{"reading=literal"},
        {"reading=consistent"},
        {"estimator.wave_frequency=estimated"},
        {"estimator.disturbance=spectrum", "estimator.wave_frequency=estimated"},
        {"estimator.disturbance=spectrum", "estimator.wave_force=given"},
        {"estimator.disturbance=spectrum", "controller.gains=given", "controller.lead_s=0.3"}}},
      {"two_inertia",
       {{"task.kind=torque_step"},
        {"task.kind=reversal", "task.reversal_s=0.2"},
        {"transmission.kinematic_error_rad=1e-3"}}}};
  std::vector<Trial> trials;
  for (const std::string& name : testing::scenario_names()) {
    const ScenarioFile file = testing::scenario_file(name);
    for (const std::string& case_name : file.cases()) {
      trials.push_back({name, case_name, brief.at(name)});
    }
    if (!more.contains(name)) continue;
    for (const std::vector<std::string>& sets : more.at(name)) {
      Trial trial{name, file.default_case(), brief.at(name)};
      trial.sets.insert(trial.sets.end(), sets.begin(), sets.end());
      trials.push_back(trial);
    }
  }
  return trials;
}

struct Result {
  std::size_t keys = 0;
  std::string changed;
  bool is_same = false;
};

// Runs the trial, then again with each ineffective key changed.
Result result_of(const Trial& trial) {
  const ScenarioFile file = testing::scenario_file(trial.scenario);
  const PreparedRun run = testing::prepare(trial.scenario, trial.case_name, trial.sets);
  const auto fresh = make_scenario(testing::catalogue(), trial.scenario);
  const Config config = file.config(trial.case_name, trial.sets);
  fresh->learn(config);
  Fields fields = fresh->fields();
  fields.read(config);
  Result result;
  std::vector<std::string> sets = trial.sets;
  for (const UnusedKey& unused : fields.unused()) {
    sets.push_back(unused.key + "=" + other_value(unused.key, config.find(unused.key)->value));
    result.changed += " " + sets.back();
    ++result.keys;
  }
  const PreparedRun other = testing::prepare(trial.scenario, trial.case_name, sets);
  const Recording one = run.scenario->run({});
  const Recording two = other.scenario->run({});
  result.is_same = one.state_hash == two.state_hash;
  return result;
}

TEST(UnusedKeys, DoNotChangeTheStateHash) {
  const std::vector<Trial> trials = all_trials();
  std::vector<Result> results(trials.size());
  on_all_cores(trials.size(), [&](std::size_t i) { results[i] = result_of(trials[i]); });
  std::size_t keys = 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_TRUE(results[i].is_same)
        << trials[i].scenario << " " << trials[i].case_name << results[i].changed;
    keys += results[i].keys;
  }
  EXPECT_GT(keys, 500U);
}

}  // namespace
}  // namespace breakwater::unused_keys_test
