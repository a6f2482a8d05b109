// Small files of a run folder: manifest.json and metrics.json; an identified.json; and the files of
// a killed run beside its log.
#include <cmath>
#include <fstream>
#include <iterator>

#include <breakwater/experiment/run_list.h>
#include <breakwater/experiment/run_manifest.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/identification/axis_parameters.h>
#include <breakwater/record/cut_run.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/record/track.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

void read_run_manifest(const std::string& text) {
  static const std::string metrics = fuzz::folder().write("metrics.json", "{\"peak_N\": 1.5}");
  fuzz::folder().write("manifest.json", text);
  const bool is_run = is_run_folder(fuzz::folder().path());
  const ListedRun run = list_run(fuzz::folder().path());
  fuzz::require(is_run || run.status == ListedRun::Status::damaged, "a run has a manifest");
  note_renderer(fuzz::folder().path(), "0", "video.mp4", "osmesa");
  check_log(fuzz::folder().path());
}

void read_run_metrics(const std::string& text) {
  static const fuzz::Folder own;
  own.write("metrics.json", text);
  for (const Metric& metric : read_metrics(own.path())) {
    fuzz::require(std::isfinite(metric.value), "a metric is finite");
  }
}

void read_identified(const std::string& text) {
  const AxisValues axis = read_identified_axis(fuzz::folder().write("identified.json", text), {});
  fuzz::require(axis[kInertia] > 0.0, "an inertia is positive");
}

constexpr fuzz::Parser kParsers[] = {{'m', "manifest", read_run_manifest},
                                     {'n', "metrics", read_run_metrics},
                                     {'i', "identified", read_identified}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
