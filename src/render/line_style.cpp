#include <breakwater/render/line_style.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>

namespace breakwater {
namespace {

// The last is of references.
constexpr std::array<const char*, kStyleColours + 1> kLight = {
    "#451de2", "#c71e2e", "#0ca162", "#9542a7", "#431341", "#5977ff", "#b58e03", "#6b7682"};
constexpr std::array<const char*, kStyleColours + 1> kDark = {
    "#258efe", "#e2790b", "#2aed81", "#ecacff", "#a76c4e", "#b8f6d3", "#faf92e", "#8c99a6"};

const std::array<std::vector<double>, kStyleDashes + 1> kDashes = {
    {{}, {9, 3}, {5, 3}, {9, 3, 2, 3}, {2, 3}, {14, 4}, {5, 3, 2, 3, 2, 3}, {4, 4}}};

// A signal has one role in its quantity, and each role its look.
const std::map<std::string, LineStyle> kRoles = {{"true", 0},
                                                 {"measured", 1},
                                                 {"sensor", 1},
                                                 {"raw", 1},
                                                 {"hat", 2},
                                                 {"estimate", 2},
                                                 {"filtered", 3},
                                                 {"command", 4},
                                                 {"applied", 5},
                                                 {"ref", kReferenceStyle},
                                                 {"reference", kReferenceStyle}};

}  // namespace

const char* light_colour(LineStyle style) {
  return kLight[static_cast<std::size_t>(colour_number(style))];
}

const char* dark_colour(LineStyle style) {
  return kDark[static_cast<std::size_t>(colour_number(style))];
}

Colour on_paper(LineStyle style) {
  const unsigned long rgb = std::strtoul(light_colour(style) + 1, nullptr, 16);
  const auto part = [&](unsigned shift) {
    return static_cast<double>(rgb >> shift & 255U) / 255.0;
  };
  return {part(16), part(8), part(0)};
}

int colour_number(LineStyle style) {
  return style < 0 ? kStyleColours : style % kStyleColours;
}

int dash_number(LineStyle style) {
  // With each turn of the colours the dashes go one on: the pairs come again after 49.
  return style < 0 ? kStyleDashes : (style + style / kStyleColours) % kStyleDashes;
}

const std::vector<double>& dashes(LineStyle style) {
  return kDashes[static_cast<std::size_t>(dash_number(style))];
}

std::optional<LineStyle> role_of_word(const std::string& word) {
  const auto role = kRoles.find(word);
  return role == kRoles.end() ? std::nullopt : std::optional(role->second);
}

std::optional<LineStyle> role_of_signal(const std::string& name) {
  for (const std::string& word : words_of(name)) {
    if (const auto role = role_of_word(word)) return role;
  }
  return std::nullopt;
}

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (c == '_' || c == '.' || c == '/') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

std::vector<LineStyle> distinct_styles(const std::vector<std::optional<LineStyle>>& preferred) {
  std::set<LineStyle> taken;
  std::vector<LineStyle> all(preferred.size(), kStyleColours * kStyleDashes);
  std::vector<bool> has_one(preferred.size());
  for (std::size_t i = 0; i < preferred.size(); ++i) {
    const auto wish = preferred[i];
    has_one[i] = wish && (*wish == kReferenceStyle || taken.insert(*wish).second);
    if (has_one[i]) all[i] = *wish;
  }
  LineStyle next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (has_one[i]) continue;
    while (!taken.insert(next).second) ++next;
    all[i] = next;
  }
  return all;
}

std::vector<LineStyle> candidate_styles(const std::vector<std::string>& names,
                                        const std::vector<std::string>& cases) {
  std::vector<std::optional<LineStyle>> preferred;
  for (const std::string& name : names) {
    const auto found = std::find(cases.begin(), cases.end(), name);
    const auto at = static_cast<LineStyle>(found - cases.begin());
    // Few candidates differ in colour, and not in their dashes alone.
    const LineStyle own = names.size() <= kStyleColours ? at % kStyleColours : at;
    preferred.push_back(found == cases.end() ? std::nullopt : std::optional(own));
  }
  return distinct_styles(preferred);
}

}  // namespace breakwater
