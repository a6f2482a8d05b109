// `breakwater waves`: a sea, checked and printed.
#pragma once

#include <string>

#include <breakwater/world/jonswap.h>

namespace breakwater {

/// What a sea's realisation has against what it should have: H_s = 4 √m0 of the spectrum and of an
/// hour, the spectrum recovered by a Fourier transform of that hour, the decay with depth against
/// e^{kz}, and the largest divergence of the velocity [1/s]. Throws std::invalid_argument as
/// check(SeaState).
std::string waves_report(const SeaState& sea);

}  // namespace breakwater
