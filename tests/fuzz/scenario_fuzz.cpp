// A scenario file and values of --set, separated by zero bytes. A file that was read and
// printed is read again as the same.
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

enum class Kind { one, two };

struct Settings {
  double number = 0.0;
  double optional = 0.5;
  int count = 0;
  std::uint64_t seed = 0;
  bool flag = false;
  std::string text;
  std::vector<double> numbers;
  std::vector<std::vector<double>> groups;
  Kind kind = Kind::one;

  // A field of each type.
  Fields fields() {
    Fields all;
    all.number("a.number", number, any(), "a number");
    all.optional_number("a.optional", optional, positive(), "a positive number");
    all.count("a.count", count, between(0, 100), "a count");
    all.count("run.seed", seed, not_negative(), "a seed");
    all.flag("a.flag", flag, "a flag");
    all.text("a.text", text, "a text");
    all.numbers("b.numbers", numbers, any(), "numbers");
    all.number_groups("b.groups", groups, any(), "groups of numbers");
    all.choice("b.kind", kind, {{"one", Kind::one}, {"two", Kind::two}}, "a choice");
    all.only_for({"a.optional"}, "b.kind", {"two"});
    return all;
  }
};

// The configuration as the run folder has it; empty if it is refused.
std::string printed(const std::string& file, const std::vector<std::string>& sets) {
  const ScenarioFile scenario(file, "fuzzed");
  std::string text;
  for (const std::string& name : scenario.cases()) {
    Settings settings;
    Fields fields = settings.fields();
    const Config config = scenario.config(name, sets);
    fields.read_finished(config);  // as pictures of an old run do
    fields.check(scenario);
    fields.read(config);
    fields.unused();
    if (text.empty()) text = fields.print("fuzzed", name);
  }
  return text;
}

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  fuzz::count("scenario");
  const std::vector<std::string> parts = fuzz::parts_of(fuzz::text_of(data, size));
  std::string first;
  try {
    first = printed(fuzz::file_with(parts[0]), {parts.begin() + 1, parts.end()});
  } catch (const std::invalid_argument&) {
    return 0;
  }
  if (first.empty()) return 0;
  try {
    fuzz::require(printed(fuzz::file_with(first), {}) == first,
                  "a printed configuration reads as it is");
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n%s\n", first.c_str(), error.what());
    fuzz::require(false, "a printed configuration is accepted");
  }
  return 0;
}
