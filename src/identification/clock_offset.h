// A difference of the clocks of input and position.
#pragma once

#include <vector>

#include <breakwater/identification/identified_axis.h>

namespace breakwater {

/// identify_axis(), also for records in which the input acts much later or earlier than its rows
/// say. If the fit has no start or no white residuals, each record's offset is searched. The range
/// is −2 s to 2 s, and at most a quarter of the record. It is where the equation of motion has the
/// least residual (start_candidates()), to about 5 ms, if windows of several lengths agree. The
/// offsets are taken if they halve the error. The delay then is what remains, and not identifiable.
Identification identify_despite_clocks(std::vector<RecordedAxis> records,
                                       std::vector<RecordedAxis> held_out,
                                       const IdentificationSettings& settings);

}  // namespace breakwater
