// The meaning of each exit status: the only table of them.
#pragma once

#include <array>
#include <string>

#include <breakwater/shell/process.h>

namespace breakwater {

struct StatusMeaning {
  Status status;
  const char* brief;  ///< for --help
  const char* text;   ///< for the reference
};

inline constexpr std::array kStatusMeanings = {
    StatusMeaning{kSuccess, "success", "The command did what it was asked to do."},
    StatusMeaning{
        kDefect, "a defect",
        "Breakwater, or a part of your own, has a defect. Please report a defect of Breakwater. "
        "`doctor` also ends with this status when something on the machine is broken, and `diff` "
        "when two runs differ."},
    StatusMeaning{kUsage, "usage or input",
                  "An option, a scenario file or another input is wrong, or a folder cannot be "
                  "written. The message names the place."},
    StatusMeaning{
        kRunFailed, "the run failed",
        "A run failed. Its `manifest.json` has the time and the reason, and `metrics.json` is "
        "absent. `sweep` ends with this status only with `--on-failure stop`, or when `--replay` "
        "gives another run. `tune` does so when no candidate met the constraints."},
    StatusMeaning{kLaterOutputFailed, "only a later output failed",
                  "The run is complete. A later output, such as its video or the printed table, "
                  "could not be made."},
    StatusMeaning{kInterrupted, "interrupted",
                  "A signal such as Ctrl-C ended the command, or the tasks of a study on a "
                  "cluster ended before it was complete. Finished runs are kept."}};

/// `Exit status: 0 success, 1 …`, for --help.
inline std::string statuses_in_brief() {
  std::string line = "Exit status:";
  for (const StatusMeaning& meaning : kStatusMeanings) {
    line += (meaning.status == kSuccess ? " " : ", ") + std::to_string(meaning.status) + " " +
            meaning.brief;
  }
  return line + ".";
}

}  // namespace breakwater
