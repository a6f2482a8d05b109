#include <breakwater/thesis/printed_references.h>

#include <fmt/format.h>

#include <cmath>

#include <breakwater/thesis/printed_results.h>

namespace breakwater {
namespace {

// "28 % below".
std::string deviation(const PrintedValue& printed, double measured) {
  const double off = measured - printed.number();
  return fmt::format("{} {}",
                     printed.standard.within.absolute
                         ? fmt::format("{:.2g}", std::abs(off))
                         : fmt::format("{:.2g} %", 100.0 * std::abs(off / printed.number())),
                     off < 0.0 ? "below" : "above");
}

// The verdict for a reader who does not know the classes.
std::string in_words(const PrintedValue& printed, double measured) {
  switch (printed.verdict(measured)) {
    case Verdict::within_class:
      return "near: " + deviation(printed, measured);
    case Verdict::not_reproduced:
      return std::isfinite(measured) ? "not reproduced: " + deviation(printed, measured)
                                     : text(Verdict::not_reproduced);
    default:
      return text(printed.verdict(measured));
  }
}

std::vector<ReferenceValue> of_case(const std::string& scenario, const std::string& case_name) {
  std::vector<ReferenceValue> values;
  for (const PrintedValue& printed : printed_values(scenario, case_name)) {
    values.push_back({printed.metric, printed.number(), printed.result.text(),
                      printed.standard.within.absolute.has_value(), [printed](double measured) {
                        const Verdict verdict = printed.verdict(measured);
                        return Agreement{
                            verdict == Verdict::reproduced || verdict == Verdict::within_class,
                            in_words(printed, measured),
                            fmt::format("{} ({})", text(verdict), rule_text(printed.standard)),
                            css_class(verdict)};
                      }});
  }
  return values;
}

}  // namespace

ReferenceKind printed_references() {
  return {"thesis", "* not reproduced: outside of its class (data/reproduced.toml)\n", of_case};
}

}  // namespace breakwater
