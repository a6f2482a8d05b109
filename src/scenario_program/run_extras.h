// What the rooms above add to a run, whichever program makes it.
#pragma once

#include <string>

#include <breakwater/scenario/command_line.h>

namespace breakwater {

/// Videos made by `video_program`, which has the command `video`, and the thesis' printed numbers.
RunExtras run_extras(const std::string& video_program);

}  // namespace breakwater
