// The keys that describe a laboratory's table and encoder.
#pragma once

#include <breakwater/config/fields.h>
#include <breakwater/recorded/recorded_axis.h>

namespace breakwater {

enum class InputActs { after, before };

/// csv.time_column, …, csv.input_acts.
void bind_record_format(Fields& fields, RecordFormat& format, InputActs& input_acts);

/// Refuses scales of 0.
void check_record_format(const Config& config);

}  // namespace breakwater
