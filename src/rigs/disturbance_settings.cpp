#include <breakwater/rigs/disturbance_settings.h>

#include <breakwater/config/column_table.h>

namespace breakwater {

void DisturbanceSettings::bind(Fields& fields, const std::string& suffix, const std::string& unit) {
  const char* const kind = "disturbance.kind";
  const std::string amplitude = "disturbance.amplitude_" + suffix;
  const std::string second = "disturbance.second_amplitude_" + suffix;
  fields.choice(kind, shape.kind,
                {{"none", DisturbanceKind::none},
                 {"step", DisturbanceKind::step},
                 {"ramp", DisturbanceKind::ramp},
                 {"sine", DisturbanceKind::sine},
                 {"two_sines", DisturbanceKind::two_sines},
                 {"chirp", DisturbanceKind::chirp},
                 {"noise", DisturbanceKind::noise},
                 {"csv", DisturbanceKind::csv}},
                "shape of the disturbance");
  fields.number(
      amplitude, shape.amplitude, any(),
      "amplitude of a step, sine or chirp [" + unit + "]; slope of a ramp [" + unit + "/s]");
  fields.number(
      "disturbance.frequency_rad_s", shape.frequency_rad_s, any(),
      "frequency of a sine, of the first of two sines, or of a chirp at its start [rad/s]");
  fields.only_for({amplitude}, kind,
                  {"step", "ramp", "sine", "two_sines", "chirp", "noise", "csv"});
  fields.only_for({"disturbance.frequency_rad_s"}, kind, {"sine", "two_sines", "chirp"});
  const auto bind_for = [&](const std::string& one, const std::string& key, double& target,
                            double standard, const Range& range, const std::string& doc) {
    fields.number(key, target, range, doc);
    fields.standard(key, {standard});
    fields.only_for({key}, kind, {one});
  };
  bind_for("two_sines", second, shape.second_amplitude, 2.0, any(),
           "amplitude of the second sine [" + unit + "]");
  bind_for("two_sines", "disturbance.second_frequency_rad_s", shape.second_frequency_rad_s, 5.0,
           any(), "frequency of the second sine [rad/s]");
  bind_for("chirp", "disturbance.end_frequency_rad_s", shape.end_frequency_rad_s, 5.0, any(),
           "frequency that a chirp reaches at a constant rate and then keeps [rad/s]");
  bind_for("chirp", "disturbance.sweep_s", shape.sweep_s, 9.0, positive(),
           "time that a chirp takes to reach its last frequency [s]");
  fields.number("disturbance.start_s", shape.start_s, not_negative(),
                "time at which the disturbance begins [s]");
  fields.optional_number(
      "disturbance.end_s", end_s, not_negative(),
      "time at which the disturbance ends; a step between both times is a pulse; 0: the "
      "end of the run [s]");
  const std::string offset = "disturbance.offset_" + suffix;
  fields.optional_number(offset, shape.offset, any(),
                         "constant part, from the start of the run [" + unit + "]");
  {
    const Fields::OfPart noise(fields, kind, "noise");
    fields.number("disturbance.hold_s", shape.hold_s, positive(),
                  "time for which each number of the noise lasts; the amplitude is its standard "
                  "deviation [s]");
  }
  const Fields::OfPart csv(fields, kind, "csv");
  fields.file(
      "disturbance.file", file,
      "table with the columns time_s, from the start, and value, a factor on the amplitude; "
      "linear between its rows, with the last value after them");
}

void DisturbanceSettings::load(const Config& config) {
  if (end_s != 0.0 && end_s <= shape.start_s) {
    config.fail("disturbance.end_s",
                "must be later than disturbance.start_s, or 0 for the end of the run");
  }
  if (shape.kind != DisturbanceKind::csv) return;
  config.blame("disturbance.file", [&] { shape.table = read_function(file, "value"); });
}

Disturbance DisturbanceSettings::make(std::uint64_t seed, const std::string& channel) const {
  Disturbance made = shape;
  if (end_s != 0.0) made.end_s = end_s;
  if (made.kind == DisturbanceKind::noise) made.noise.emplace(seed, channel);
  return made;
}

}  // namespace breakwater
