// The keys that describe a laboratory's table and encoder.
#pragma once

#include <string>

#include <breakwater/config/fields.h>
#include <breakwater/recorded/recorded_axis.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

enum class InputActs { after, before };

/// csv.time_column, …, csv.input_acts.
void bind_record_format(Fields& fields, RecordFormat& format, InputActs& input_acts);

/// Refuses scales of 0.
void check_record_format(const Config& config);

/// "key=value" with 12 digits, for --set.
std::string number_set(const char* key, double value);
/// encoder.rounding, for --set.
std::string rounding_set(EncoderRounding rounding);

}  // namespace breakwater
