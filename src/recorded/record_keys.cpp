#include <breakwater/recorded/record_keys.h>

#include <fmt/format.h>

namespace breakwater {

void bind_record_format(Fields& fields, RecordFormat& format, InputActs& input_acts) {
  fields.text("csv.time_column", format.time_column, "name of the column of times");
  fields.text("csv.input_column", format.input_column, "name of the column of inputs u");
  fields.text("csv.position_column", format.position_column, "name of the column of positions y");
  fields.standard("csv.time_column", {std::string("time_s")});
  fields.standard("csv.input_column", {std::string("u")});
  fields.standard("csv.position_column", {std::string("y")});
  fields.number("csv.time_scale", format.time_scale, positive(),
                "unit of the column of times in s: 1e-3 for milliseconds");
  fields.standard("csv.time_scale", {1.0});
  fields.number("csv.input_scale", format.input_scale, any(),
                "unit of the column u in N m or N, with sign: a torque constant, for example");
  fields.number("csv.position_scale", format.position_scale, any(),
                "unit of the column y in rad or m, with sign");
  fields.choice("csv.input_acts", input_acts,
                {{"after", InputActs::after}, {"before", InputActs::before}},
                "interval in which u of a row acts: after the row, or before it");
}

void check_record_format(const Config& config) {
  for (const char* key : {"csv.input_scale", "csv.position_scale"}) {
    if (config.number(key) == 0.0) config.fail(key, "must not be 0");
  }
}

std::string number_set(const char* key, double value) {
  return fmt::format("{}={:.12g}", key, value);
}

std::string rounding_set(EncoderRounding rounding) {
  return rounding == EncoderRounding::nearest ? "encoder.rounding=nearest"
                                              : "encoder.rounding=truncate";
}

}  // namespace breakwater
