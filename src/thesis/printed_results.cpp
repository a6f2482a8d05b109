#include <breakwater/thesis/printed_results.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/paths.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

// In the order of the enumeration.
constexpr struct {
  const char *text, *tone;
} kVerdicts[] = {{"reproduced", "good"},    {"within the class", "near"},
                 {"not reproduced", "off"}, {"not measured", "unknown"},
                 {"vacuous", "unknown"},    {"shown", "unknown"}};

bool matches(const char* pattern, const char* path) {
  if (*pattern == '*')
    return matches(pattern + 1, path) || (*path != '\0' && matches(pattern, path + 1));
  if (*pattern == '\0' || *path == '\0') return *pattern == *path;
  return *pattern == *path && matches(pattern + 1, path + 1);
}

// The lines of a file, to read numbers as they are written.
class Lines {
 public:
  explicit Lines(const std::string& file) : file_(file) {
    std::ifstream stream = open_input(file);
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
  }

  // Throws std::invalid_argument if the number is not at the parser's position, which happens
  // behind non-ASCII characters.
  PrintedResult number(const toml::node& node, double value) const {
    const toml::source_region& place = node.source();
    const std::string& line = lines_.at(place.begin.line - 1);
    const std::size_t begin = std::min<std::size_t>(place.begin.column - 1, line.size());
    const std::string digits = line.substr(begin, line.find_first_of(" \t,]}#\r", begin) - begin);
    const char* const end = digits.data() + digits.size();
    double read = 0.0;
    const auto result = std::from_chars(digits.data(), end, read);
    if (result.ec != std::errc() || result.ptr != end || read != value) {
      throw std::invalid_argument(at_line(file_, place) + ": \"" + digits +
                                  "\" is no plain number");
    }
    return {value, digits, half_unit(digits)};
  }

 private:
  // Half a unit of the last digit: 00.05 for "66.0", 0.005e-13 for "1.00e-13".
  static double half_unit(const std::string& digits) {
    const std::size_t e = std::min(digits.find_first_of("eE"), digits.size());
    std::string half = digits.substr(0, e);
    std::ranges::replace_if(
        half, [](char c) { return c != '.'; }, '0');
    half += (half.find('.') == std::string::npos ? ".5" : "5") + digits.substr(e);
    double read = 0.0;  // also if it is too small for a number
    std::from_chars(half.data(), half.data() + half.size(), read);
    return read;
  }

  std::string file_;
  std::vector<std::string> lines_;
};

void collect(const toml::node& node, const std::string& path, const Lines& lines,
             std::map<std::string, PrintedResult>& results) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) {
      collect(child, path.empty() ? std::string(key.str()) : path + "." + std::string(key.str()),
              lines, results);
    }
  } else if (const toml::array* array = node.as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      collect(*array->get(i), fmt::format("{}[{}]", path, i), lines, results);
    }
  } else if (const auto number = node.value<double>(); number && !node.is_boolean()) {
    results[path] = lines.number(node, *number);
  } else if (const auto yes = node.value<bool>(); yes && node.is_boolean()) {
    results[path] = {std::nullopt, *yes ? "true" : "false"};
  } else {
    results[path] = {std::nullopt, node.value_or(std::string())};
  }
}

Band read_band(const TomlEntry& table) {
  if (!table) table.fail("is missing");
  table.allow({"relative", "absolute", "above", "below"});
  return {table["relative"].number_or_nothing(), table["absolute"].number_or_nothing(),
          table["above"].number_or_nothing(), table["below"].number_or_nothing()};
}

Standard read_standard(const TomlEntry& table) {
  Standard standard;
  for (const auto& [word, band] : table["words"].entries()) {
    standard.words.emplace_back(word, read_band(band));
  }
  if (table["words"]) return standard;
  standard.reproduced = read_band(table["reproduced"]);
  standard.within = read_band(table["within"]);
  return standard;
}

}  // namespace

bool Band::contains(double measured, double printed) const {
  const double off = std::abs(measured - printed);
  return !std::isnan(measured) && !(relative && !(off <= *relative * std::abs(printed))) &&
         !(absolute && !(off <= *absolute)) && !(above && measured < *above) &&
         !(below && measured >= *below);
}

std::string Band::text() const {
  std::vector<std::string> parts;
  if (relative) parts.push_back(fmt::format("±{:g} %", 100.0 * *relative));
  if (absolute) parts.push_back(fmt::format("±{:g}", *absolute));
  if (above) parts.push_back(fmt::format("from {:g}", *above));
  if (below) parts.push_back(fmt::format("below {:g}", *below));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string PrintedResult::text() const {
  return word == "true" ? "yes" : word == "false" ? "no" : word;
}

Verdict judge(double measured, const PrintedResult& printed, const Standard& standard) {
  if (std::isnan(measured)) return Verdict::not_measured;
  if (printed.number) {
    const double off = std::abs(measured - *printed.number);
    if (standard.reproduced.is_around() && off <= printed.half_unit) return Verdict::reproduced;
    if (standard.reproduced.contains(measured, *printed.number)) return Verdict::reproduced;
    if (standard.within.contains(measured, *printed.number)) return Verdict::within_class;
    return Verdict::not_reproduced;
  }
  const bool is_reproduced =
      std::any_of(standard.words.begin(), standard.words.end(), [&](const auto& entry) {
        return entry.first == printed.word && entry.second.contains(measured);
      });
  return is_reproduced ? Verdict::reproduced : Verdict::not_reproduced;
}

std::string css_class(Verdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].tone;
}

std::string text(Verdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].text;
}

std::string rule_text(const Standard& standard) {
  const char* const digits = standard.reproduced.is_around() ? " or what rounds to it" : "";
  return fmt::format("reproduced: {}{}; class: {}", standard.reproduced.text(), digits,
                     standard.within.text());
}

PrintedResults::PrintedResults(const std::filesystem::path& folder) {
  const std::string printed = (folder / "printed-results.toml").string();
  collect(parse_toml_file(printed), "", Lines(printed), results_);
  const std::string name = (folder / "reproduced.toml").string();
  const toml::table tables = parse_toml_file(name);
  const TomlEntry root(tables, name);
  for (const char* key : {"class", "case"}) {
    if (!root[key]) root[key].fail("is missing");
  }
  for (const TomlEntry& one : root["class"].elements()) {
    if (!one["of"]) one["of"].fail("is missing");
    for (const TomlEntry& pattern : one["of"].elements()) {
      standards_.emplace_back(pattern.text(), read_standard(one));
    }
  }
  for (const auto& [scenario, cases] : root["case"].entries()) {
    for (const auto& [case_name, metrics] : cases.entries()) {
      const std::string path = metrics["printed"].text();
      for (const auto& [ours, theirs] : metrics.entries()) {
        if (ours == "printed") continue;
        cases_[scenario + "/" + case_name][ours] = path + "." + theirs.text();
      }
    }
  }
}

std::optional<PrintedResult> PrintedResults::find(const std::string& path) const {
  const auto found = results_.find(path);
  if (found == results_.end()) return std::nullopt;
  return found->second;
}

const Standard& PrintedResults::standard(const std::string& path) const {
  for (const auto& [pattern, standard] : standards_) {
    if (matches_pattern(pattern, path)) return standard;
  }
  throw std::runtime_error("reproduced.toml has no class for " + path);
}

std::vector<PublishedValue> PrintedResults::of_case(const std::string& scenario,
                                                    const std::string& case_name) const {
  std::vector<PublishedValue> values;
  const auto metrics = cases_.find(scenario + "/" + case_name);
  if (metrics == cases_.end()) return values;
  for (const auto& [metric, path] : metrics->second) {
    const auto printed = find(path);
    if (!printed || !printed->number) {
      throw std::runtime_error("printed-results.toml has no number " + path);
    }
    const Standard& its = standard(path);
    values.push_back({metric, *printed->number, printed->text(), its.within.absolute.has_value(),
                      [=](double measured) {
                        const Verdict verdict = judge(measured, *printed, its);
                        return Agreement{verdict <= Verdict::within_class,
                                         verdict == Verdict::within_class ? "near" : text(verdict),
                                         fmt::format("{} ({})", text(verdict), rule_text(its)),
                                         css_class(verdict)};
                      }});
  }
  return values;
}

bool matches_pattern(const std::string& pattern, const std::string& text) {
  return matches(pattern.c_str(), text.c_str());
}

const PrintedResults& printed_results() {
  static const PrintedResults results(data_file("data/reproduced.toml").parent_path());
  return results;
}

ReferenceKind printed_references() {
  return {"thesis", "* not reproduced: outside of its class (data/reproduced.toml)\n",
          [](const std::string& scenario, const std::string& case_name) {
            return printed_results().of_case(scenario, case_name);
          }};
}

}  // namespace breakwater
