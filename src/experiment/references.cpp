#include <breakwater/experiment/references.h>

#include <fmt/format.h>

namespace breakwater {

std::string PublishedValue::deviation(double measured) const {
  return is_near_zero ? fmt::format("{:+.1g}", measured - number)
                      : fmt::format("{:+.1f} %", 100.0 * (measured / number - 1.0));
}

std::map<std::string, PublishedValue> published_values(const Catalogue& catalogue,
                                                       const std::string& scenario,
                                                       const std::string& case_name) {
  std::map<std::string, PublishedValue> values;
  for (const ReferenceKind& source : catalogue.all<ReferenceKind>()) {
    for (PublishedValue& value : source.of_case(scenario, case_name)) {
      values.emplace(value.metric, std::move(value));
    }
  }
  return values;
}

}  // namespace breakwater
