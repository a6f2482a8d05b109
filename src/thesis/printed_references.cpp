#include <breakwater/thesis/printed_references.h>

#include <fmt/format.h>

#include <breakwater/thesis/printed_results.h>

namespace breakwater {
namespace {

std::vector<ReferenceValue> of_case(const std::string& scenario, const std::string& case_name) {
  std::vector<ReferenceValue> values;
  for (const PrintedValue& printed : printed_values(scenario, case_name)) {
    values.push_back({printed.metric, printed.number(), printed.result.text(),
                      printed.standard.within.absolute.has_value(), [printed](double measured) {
                        const Verdict verdict = printed.verdict(measured);
                        return Agreement{
                            verdict == Verdict::reproduced || verdict == Verdict::within_class,
                            verdict == Verdict::within_class ? "near" : text(verdict),
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
