// Repairs of a laboratory's table of times, inputs and positions.
#pragma once

#include <string>

#include <breakwater/config/column_table.h>
#include <breakwater/recorded/recorded_axis.h>

namespace breakwater {

/// Repairs the columns time, input and position of a table, in the file's units, and counts it:
/// - rows without a time are left out
/// - rows out of order are sorted, if they are few and close to their place
/// - repeated rows are left out; stamps of a coarse clock are spread evenly
/// - a missing input is interpolated; an input of a lower rate is held
/// - rows without a position are left out; for a position of a lower rate, the inputs between two
///   positions become their mean
/// - a counter that wraps is unwrapped, and one that is reset to 0 goes on; a single position far
///   from both neighbours is left out
///
/// Throws std::invalid_argument `FILE[:LINE]: reason` if the times start again, a column has no
/// number, or fewer than two rows are left. `time_column` is its name in messages.
RecordedAxis repaired(const std::string& file, const ColumnTable& table,
                      const std::string& time_column);

}  // namespace breakwater
