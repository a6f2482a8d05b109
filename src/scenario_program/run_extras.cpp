#include <breakwater/scenario_program/run_extras.h>

#include <breakwater/printed/printed_results.h>
#include <breakwater/scenario_program/video_later.h>

namespace breakwater {
namespace {

std::vector<ReferenceValue> printed_references(const std::string& scenario,
                                               const std::string& case_name) {
  std::vector<ReferenceValue> values;
  for (const PrintedValue& printed : printed_values(scenario, case_name)) {
    values.push_back({printed.metric, printed.number(), printed.result.text(),
                      printed.standard.within.absolute.has_value(), [printed](double measured) {
                        const Verdict verdict = printed.verdict(measured);
                        return verdict == Verdict::reproduced || verdict == Verdict::within_class;
                      }});
  }
  return values;
}

}  // namespace

RunExtras run_extras(const std::string& video_program) {
  return {std::filesystem::path(video_program).filename().string(),
          [video_program](const std::filesystem::path& folder, const std::string& file,
                          bool quiet) { return make_video(video_program, folder, file, quiet); },
          {printed_references, "* not reproduced: outside of its class (data/reproduced.toml)\n"}};
}

}  // namespace breakwater
