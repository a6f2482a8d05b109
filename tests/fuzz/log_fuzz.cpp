// A log.h5 of unknown origin in a run folder, with all its signals. A child process reads it.
#include <breakwater/experiment/saved_run.h>
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  const fuzz::Folder& folder = fuzz::folder();
  static const std::string files[] = {
      folder.write("config.toml", "scenario = \"s\"\n[case.c]\n"),
      folder.write("metrics.json", "{}"),
      folder.write(
          "manifest.json",
          R"({"scenario": "s", "case": "c", "seed": 1, "state_hash": "0", "status": "complete"})")};
  fuzz::count("log");
  folder.write("log.h5", fuzz::text_of(data, size));
  try {
    const SavedRun run(folder.path());
    for (const LogEntry& entry : run.signals()) {
      const std::string name = entry.group + "/" + entry.name;
      for (std::size_t i = 1; i <= std::min<std::size_t>(entry.width, 3); ++i) {
        const std::string one = entry.width == 1 ? name : name + "[" + std::to_string(i) + "]";
        try {
          run.unit(one);
          const Series series = run.signal(one);
          fuzz::require(series.times_s.size() == series.values.size(), "each value has a time");
        } catch (const std::invalid_argument&) {
          // its group has no times
        }
      }
    }
  } catch (const std::invalid_argument&) {
    // refused
  }
  return 0;
}
