#include <breakwater/pages/labels.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>
#include <vector>

#include <breakwater/render/identity.h>

namespace breakwater {
namespace {

// Words of keys that are short for something.
const std::map<std::string, std::string> kWords = {
    {"hat", "estimated"}, {"estimate", "estimated"}, {"ref", "reference"}, {"rmse", "RMSE of"},
    {"rms", "RMS of"},    {"std", "deviation of"},   {"max", "largest"},   {"min", "smallest"},
    {"qp", "QP"},         {"nees", "NEES"},          {"5pct", "to 5 %"},   {"99pct", "to 99 %"}};

// The words of a name in full. "RMSE of" needs a word that follows and is not "of" itself.
void put_in_words(std::vector<std::string>& words) {
  constexpr std::string_view kOf = " of";
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto found = kWords.find(words[i]);
    if (found == kWords.end()) continue;
    words[i] = found->second;
    const bool has_object = i + 1 < words.size() && words[i + 1] != "of";
    if (words[i].ends_with(kOf) && !has_object) words[i].resize(words[i].size() - kOf.size());
  }
}

// "rad_s2" of "rad/s^2": how a unit ends a name.
std::string suffix_of(const std::string& unit) {
  std::string suffix = "_";
  for (const char c : unit) {
    if (c == '/') suffix += '_';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) suffix += c;
  }
  return suffix;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() || unit == "1" ? label : fmt::format("{} [{}]", label, unit);
}

struct Split {
  std::vector<std::string> quantity, roles;
};

Split split(const std::string& name, const std::string& unit) {
  Split parts;
  for (const std::string& word : words_of(without_unit(name, unit))) {
    (role_of_word(word) ? parts.roles : parts.quantity).push_back(word);
  }
  return parts;
}

}  // namespace

std::string without_unit(const std::string& name, const std::string& unit) {
  for (const std::string& one : {unit, unit.substr(0, unit.find(", "))}) {
    // "²" is two bytes that are no letters.
    std::string plain = one;
    const std::size_t square = plain.find("²");
    if (square != std::string::npos) plain.replace(square, std::string("²").size(), "2");
    const std::string suffix = suffix_of(plain);
    if (suffix.size() > 1 && name.size() > suffix.size() && name.ends_with(suffix)) {
      return name.substr(0, name.size() - suffix.size());
    }
  }
  return name;
}

std::string metric_label(const std::string& metric, const std::string& unit) {
  Split parts = split(metric, unit.empty() ? "1" : unit);
  put_in_words(parts.quantity);
  put_in_words(parts.roles);
  const std::string quantity = joined(parts.quantity);
  return capitalised(parts.roles.empty() || quantity.empty()
                         ? quantity + joined(parts.roles)
                         : quantity + ", " + joined(parts.roles));
}

std::string metric_label_with_unit(const std::string& metric, const std::string& unit) {
  return with_unit(metric_label(metric, unit), unit);
}

std::string key_label_with_unit(const std::string& key, const std::string& unit) {
  const std::size_t bracket = std::min(key.find('['), key.size());  // an element's
  std::string label = without_unit(key.substr(0, bracket), unit) + " " + key.substr(bracket);
  if (label.ends_with(' ')) label.pop_back();
  std::replace_if(
      label.begin(), label.end(), [](char c) { return c == '.' || c == '_'; }, ' ');
  return with_unit(label, unit);
}

std::string quantity_of(const LogEntry& entry) {
  return joined(split(entry.name, entry.unit).quantity);
}

std::string signal_label(const LogEntry& entry) {
  Split parts = split(entry.name, entry.unit);
  put_in_words(parts.roles);
  return joined(parts.roles.empty() ? parts.quantity : parts.roles);
}

std::string capitalised(std::string text) {
  constexpr std::size_t kLongestSymbol = 2;
  if (text.find(' ') > kLongestSymbol && !text.empty() && text.size() > kLongestSymbol) {
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  }
  return text;
}

}  // namespace breakwater
