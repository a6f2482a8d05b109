#include <breakwater/study/study_summary.h>

#include <algorithm>
#include <utility>

#include <breakwater/statistics/quantile.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// In the order of a run's metrics. The cases of a study may have different metrics.
std::vector<std::pair<std::string, std::vector<double>>> values_of(
    const std::unordered_map<std::string, PointResult>& results) {
  std::vector<std::pair<std::string, std::vector<double>>> all;
  std::unordered_map<std::string, std::size_t> places;
  for (const auto& [key, result] : results) {
    for (const auto& [name, value] : result.metrics) {
      const auto [place, is_new] = places.emplace(name, all.size());
      if (is_new) all.emplace_back(name, std::vector<double>());
      all[place->second].second.push_back(value);
    }
  }
  return all;
}

}  // namespace

bool is_study_folder(const fs::path& folder) {
  std::error_code ignored;  // a folder that cannot be read is no study
  return fs::is_directory(folder / "shards", ignored) &&
         (fs::exists(folder / kSweep.file, ignored) || fs::exists(folder / kTune.file, ignored));
}

StudySummary summarise_study(const fs::path& folder) {
  StudySummary summary;
  summary.folder = folder;
  const bool is_tuning = !fs::exists(folder / kSweep.file);
  if (is_tuning) summary.kind = "tuning";
  const std::string file = (folder / (is_tuning ? kTune : kSweep).file).string();
  const toml::table tables = study_tables(file);
  summary.scenario = study_root(tables, file)["scenario"].text_or_nothing();
  const auto results = results_by_key(folder / "shards");
  summary.runs = results.size();
  summary.failed =
      static_cast<std::size_t>(std::count_if(results.begin(), results.end(), [](const auto& entry) {
        return entry.second.status != PointStatus::complete;
      }));
  for (auto& [name, values] : values_of(results)) {
    std::sort(values.begin(), values.end());
    summary.medians.push_back({name, "", quantile(values, 0.5)});
  }
  std::error_code ignored;
  summary.written = fs::last_write_time(folder / "shards", ignored);
  return summary;
}

}  // namespace breakwater
