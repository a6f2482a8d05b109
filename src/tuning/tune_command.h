// `breakwater tune`: the best values of some keys, and what they are worth elsewhere.
#pragma once

#include <filesystem>
#include <functional>

#include <breakwater/scenario/catalogue.h>
#include <breakwater/tuning/tuner.h>

namespace breakwater {

/// What other rooms add to a tuning.
struct TuningExtras {
  /// Writes DIR/report.html; may be empty.
  std::function<void(const TuningPlan&, const TuningResult&, const std::filesystem::path& folder)>
      write_report;
};

inline constexpr const char* kTune = "tune";

/// Returns the exit status: 0 the tuning is done, 1 a defect, 2 usage or input, 3 no candidate met
/// the constraints or survived, 130 interrupted.
int tune_main(const Catalogue& catalogue, const TuningExtras& extras, int argc,
              const char* const* argv);

}  // namespace breakwater
