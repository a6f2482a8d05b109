#include <breakwater/identification/clock_offset.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>

#include <breakwater/identification/axis_start.h>
#include <breakwater/recorded/encoder_quantum.h>

namespace breakwater {
namespace {

constexpr double kPeriod = 5e-3;  // s, of the rows that the search uses
constexpr double kLargest = 2.0;  // s
constexpr double kLeast = 0.01;   // s: a fitted delay covers a smaller one
constexpr std::size_t kLeastVotes = 3;

// The time by which the input acts later than its rows say; 0 if no offset is clear.
double clock_offset(const RecordedAxis& record, const IdentificationSettings& settings) {
  AxisData data = axis_data({record}, settings.inputs_act_before, 0.0);
  if (data.stretches.empty()) return 0.0;
  const auto every = static_cast<std::size_t>(std::max(1.0, std::round(kPeriod / data.period_s)));
  data.quantum = settings.quantum ? *settings.quantum : encoder_quantum(record.positions);
  data.period_s *= static_cast<double>(every);
  for (AxisStretch& stretch : data.stretches) {
    std::vector<double> times_s, positions;
    for (std::size_t k = 0; k < stretch.times_s.size(); k += every) {
      times_s.push_back(stretch.times_s[k]);
      positions.push_back(stretch.positions[k]);
    }
    stretch.times_s = std::move(times_s);
    stretch.positions = std::move(positions);
  }
  const double range = std::min(kLargest, 0.25 * (record.times_s.back() - record.times_s.front()));
  const std::vector<AxisValues> candidates = start_candidates(data, -range, range);
  double best = 0.0;
  std::size_t most = kLeastVotes - 1;
  for (const AxisValues& one : candidates) {
    const auto votes = static_cast<std::size_t>(
        std::count_if(candidates.begin(), candidates.end(), [&](const AxisValues& other) {
          return std::abs(other[kDelay] - one[kDelay]) <= data.period_s;
        }));
    if (votes <= most) continue;
    most = votes;
    best = one[kDelay];
  }
  return best;
}

// Moves the inputs of each record by its offset. Returns the offsets.
std::vector<double> corrected(std::vector<RecordedAxis>& records,
                              const IdentificationSettings& settings) {
  std::vector<double> offsets;
  for (RecordedAxis& record : records) {
    const double found = clock_offset(record, settings);
    offsets.push_back(std::abs(found) < kLeast ? 0.0 : found);
    if (record.input_times_s.empty()) {
      record.input_times_s = record.times_s;
      record.all_inputs = record.inputs;
    }
    for (double& t : record.input_times_s) t += offsets.back();
  }
  return offsets;
}

}  // namespace

Identification identify_despite_clocks(std::vector<RecordedAxis> records,
                                       std::vector<RecordedAxis> held_out,
                                       const IdentificationSettings& settings) {
  std::optional<Identification> plain;
  std::exception_ptr refusal;
  try {
    plain = identify_axis(records, held_out, settings);
    if (!plain->parameters.empty() && plain->whiteness.is_white()) return *plain;
  } catch (const std::invalid_argument&) {
    refusal = std::current_exception();
  }
  const std::vector<double> offsets = corrected(records, settings);
  if (std::all_of(offsets.begin(), offsets.end(), [](double offset) { return offset == 0.0; })) {
    if (!plain) std::rethrow_exception(refusal);
    return *plain;
  }
  corrected(held_out, settings);
  Identification found;
  try {
    found = identify_axis(records, held_out, settings);
  } catch (const std::invalid_argument&) {
    if (!plain) std::rethrow_exception(refusal);
    return *plain;
  }
  if (plain && !plain->parameters.empty() &&
      (found.parameters.empty() || found.errors.rms > 0.5 * plain->errors.rms)) {
    return *plain;
  }
  found.notes.push_back(fmt::format(
      "the clocks of u and y differ: u acts later by {:.3g} s. The delay is what remains",
      fmt::join(offsets, " s, ")));
  for (ParameterEstimate& estimate : found.parameters) {
    if (estimate.parameter != kDelay) continue;
    estimate.is_identifiable = false;
    estimate.reason = "the clocks of u and y differ, and a delay acts alike";
    estimate.excitation = "a record of both with one clock";
  }
  return found;
}

}  // namespace breakwater
