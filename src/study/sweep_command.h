// `breakwater sweep`: studies of many runs.
#pragma once

#include <functional>
#include <optional>

#include <breakwater/scenario/catalogue.h>
#include <breakwater/study/paired_comparison.h>
#include <breakwater/study/results.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// What other rooms add to a study.
struct StudyExtras {
  /// Writes DIR/report.html, with what compares the candidates, if there are several; may be empty.
  std::function<void(const Plan&, const ShardIndex&, const StudyFolder&,
                     const std::optional<CandidateComparison>&)>
      write_report;
};

inline constexpr const char* kSweep = "sweep";

/// `sweep` and what stands behind it. Returns the exit status: 0 all points are done, failed ones
/// included; 1 a defect, 2 usage or input, 3 a run failed and the study is to stop then, 130
/// interrupted.
int sweep_main(const Catalogue& catalogue, const StudyExtras& extras, int argc,
               const char* const* argv);

}  // namespace breakwater
