#include <breakwater/experiment/run_manifest.h>

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/config/unit_of.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

using nlohmann::ordered_json;

// The object with these `keys` in a file. Throws std::invalid_argument `FILE: WHAT (line 3 is no
// JSON); ADVICE`.
ordered_json read_object(const std::filesystem::path& file, std::initializer_list<const char*> keys,
                         const std::string& what, const std::string& advice) {
  const std::string text = bytes_of(file);
  std::string where;
  try {
    ordered_json object = ordered_json::parse(text);
    const auto has = [&](const char* key) { return object.contains(key); };
    if (object.is_object() && std::all_of(keys.begin(), keys.end(), has)) return object;
  } catch (const ordered_json::parse_error& error) {
    const std::size_t end = std::min(error.byte, text.size());
    const auto before = text.begin() + static_cast<std::ptrdiff_t>(end == 0 ? 0 : end - 1);
    where = fmt::format(" (line {} is no JSON)", 1 + std::count(text.begin(), before, '\n'));
  } catch (const ordered_json::exception&) {  // a number out of range
  }
  throw std::invalid_argument(file.string() + ": " + what + where + "; " + advice);
}

}  // namespace

RunManifest read_manifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  const ordered_json object = read_object(file, {"scenario", "state_hash"},
                                          "is not a run's manifest", "give the folder of a run");
  const auto fail = [&](const char* key) {
    throw std::invalid_argument(file.string() + ": " + key +
                                ": is missing or wrong: the manifest is damaged; run it again");
  };
  const auto get = [&](const char* key, auto& target) {
    const auto value = object.find(key);
    // A boolean would pass for a number.
    if (value == object.end() || value->is_boolean()) fail(key);
    try {
      value->get_to(target);
    } catch (const ordered_json::exception&) {
      fail(key);
    }
  };
  const auto get_if_there = [&](const char* key, auto& target) {
    if (object.contains(key)) get(key, target);
  };
  RunManifest manifest;
  get("scenario", manifest.scenario);
  get("case", manifest.case_name);
  if (!object.contains("seed") || !object["seed"].is_number_unsigned()) fail("seed");
  manifest.seed = object["seed"].dump();
  get("state_hash", manifest.state_hash);
  std::string status;
  get("status", status);
  manifest.is_unfinished = status == kRunning;
  if (manifest.is_unfinished) {
    manifest.failure = Failure{0.0, "its process ended before the run did", true};
  } else if (status == "failed" || status == "cut") {  // a log that was recovered
    Failure& failure = manifest.failure.emplace(Failure{0.0, "", status == "cut"});
    get("time_s", failure.time_s);
    get("reason", failure.reason);
  } else if (status != "complete") {
    fail("status");
  }
  get_if_there("program", manifest.program);
  get_if_there("models", manifest.models);
  get_if_there("warnings", manifest.warnings);
  std::map<std::string, std::string> absent;
  get_if_there("absent", absent);
  for (const auto& [name, reason] : absent) manifest.absent.push_back({name, "", reason});
  return manifest;
}

std::vector<Metric> read_metrics(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "metrics.json";
  if (!std::filesystem::is_regular_file(file)) {
    throw std::invalid_argument(folder.string() +
                                ": the run is incomplete: it has no metrics.json; run it again");
  }
  std::vector<Metric> list;
  const ordered_json metrics = read_object(file, {}, "is no object of numbers", "run it again");
  for (const auto& [name, value] : metrics.items()) {
    if (value.is_null()) continue;  // version 0.1 wrote null for a number that is not finite
    if (!value.is_number()) {
      throw std::invalid_argument(file.string() + ": " + name +
                                  ": must be a number: the file is damaged; run it again");
    }
    try {
      list.emplace_back(name, unit_of(name), value.get<double>());
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(file.string() + ": " + error.what());
    }
  }
  check_file(folder, "metrics.json");
  return list;
}

}  // namespace breakwater
