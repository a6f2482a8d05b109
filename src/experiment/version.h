// The version of this build. The values are in a source of their own (cmake/version.cpp.in), so a
// commit recompiles nothing else.
#pragma once

namespace breakwater {

extern const char* const kVersion;    ///< "0.2.0"
extern const char* const kGitCommit;  ///< "1a2b3c4d5e6f", with "-dirty" if files were changed

}  // namespace breakwater
