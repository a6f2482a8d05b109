#include <breakwater/pages/html_page.h>

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cstdint>
#include <kainjow/mustache.hpp>
#include <regex>
#include <set>
#include <stdexcept>

#include <breakwater/experiment/version.h>
#include <breakwater/render/scene_description.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/table.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace mustache = kainjow::mustache;
namespace {

fs::path part(const std::string& name) {
  return data_file("data/report/" + name);
}

constexpr const char* kCharts = BREAKWATER_DYGRAPHS "/dygraph.min.js";
constexpr const char* kChartStyle = BREAKWATER_DYGRAPHS "/dygraph.min.css";
constexpr const char* kThree = BREAKWATER_THREE "/three.min.js";
constexpr const char* kOrbit = BREAKWATER_THREE "/examples/js/controls/OrbitControls.js";

// The colours and dashes of lines as CSS: c0 …, d0 …, and the same as --c0 …, --d0 … for
// scripts. The last of each are references'.
std::string css_of_lines() {
  std::string light, dark, classes;
  for (int k = 0; k <= kStyleColours; ++k) {
    const LineStyle style = k < kStyleColours ? k : kReferenceStyle;
    light += fmt::format("--c{}:{};", k, light_colour(style));
    dark += fmt::format("--c{}:{};", k, dark_colour(style));
    classes += fmt::format(".c{0}{{--c:var(--c{0})}}\n", k);
    // Each of the first ones has the dash with its own number.
    std::string strip, lengths;
    double at = 0.0;
    bool is_stroke = false;
    for (const double length : dashes(style)) {
      is_stroke = !is_stroke;
      strip +=
          fmt::format(",{} {}px {}px", is_stroke ? "var(--c)" : "transparent", at, at + length);
      at += length;
      lengths += fmt::format("{} ", length);
    }
    light += fmt::format("--d{}:{};", k, lengths.empty() ? "none" : lengths);
    classes += fmt::format(
        ".d{0} .line,.line.d{0}{{stroke-dasharray:var(--d{0})}}.d{0}>i{{background:{1}}}\n", k,
        strip.empty() ? "var(--c)" : fmt::format("repeating-linear-gradient(90deg{})", strip));
  }
  return fmt::format(
      ":root{{{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{}}}}}\n{}", light, dark,
      classes);
}

constexpr std::array kTemplates = {"page", "block", "cell"};

// The names of the templates' sections.
const std::set<std::string>& section_names() {
  static const std::set<std::string> names = [] {
    const std::regex section("\\{\\{[#^](\\w+)");
    std::set<std::string> all;
    for (const char* name : kTemplates) {
      const std::string text = bytes_of(part(name + std::string(".mustache")));
      for (std::sregex_iterator found(text.begin(), text.end(), section), end; found != end;
           ++found) {
        all.insert((*found)[1]);
      }
    }
    return all;
  }();
  return names;
}

mustache::data for_templates(const PageData& value);

// A row of a table: the first cell is its head, as all of the columns are.
mustache::data cells_of(const PageData& row, bool is_head) {
  mustache::data cells(mustache::data::type::list);
  for (const PageData& value : row) {
    const bool is_first = &value == &row.front();
    mustache::data cell = value.is_object() ? for_templates(value) : mustache::data();
    if (!value.is_object() || value.contains("value")) cell.set("value", text_of(value));
    cell.set("is_rich", value.is_object());
    cell.set("letter", is_head || is_first ? "h" : "d");
    cell.set("scope", false);
    if (is_head || is_first) cell.set("scope", is_head ? "col" : "row");
    cells << cell;
  }
  return cells;
}

// The analyser does not see that mustache::data owns its parts.
// NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks)
mustache::data for_templates(const PageData& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_object()) {
    mustache::data object;
    // An object has nothing from one around it.
    for (const std::string& name : section_names()) object.set(name, false);
    for (const auto& [name, member] : value.items()) {
      if (name == "data") continue;
      object.set(name, name == "columns" ? cells_of(member, true) : for_templates(member));
      if (member.is_array() && !value.contains("has_" + name)) {
        object.set("has_" + name, !member.empty());
      }
    }
    return object;
  }
  if (value.is_array()) {
    mustache::data list(mustache::data::type::list);
    for (const PageData& member : value) {
      list << (member.is_array() ? mustache::data("cells", cells_of(member, false))
                                 : for_templates(member));
    }
    return list;
  }
  const std::string text = text_of(value);
  return value.is_null() || text.empty() ? mustache::data(false) : mustache::data(text);
}

// Takes what the scripts do not need out of a page's data, and sees what it has.
void take_apart(PageData& data, bool& has_charts, bool& has_replays) {
  if (data.is_string() && data.get_ref<const std::string&>().starts_with("data:")) data = nullptr;
  if (!data.is_structured()) return;
  if (data.is_object()) {
    data.erase("machine");
    has_charts |= data.contains("over");
    has_replays |= data.contains("time") && data.contains("strip");
  }
  for (const auto& [name, member] : data.items()) {
    if (name != "data") take_apart(member, has_charts, has_replays);
  }
}

// The entries of the contents, unless the page has its own.
PageData contents_of(const PageData& data) {
  if (data.contains("toc")) return data["toc"];
  auto toc = PageData::array();
  for (const PageData& section : data.value("sections", PageData::array())) {
    toc.push_back({{"href", section["id"]},
                   {"label", section.value("heading", "")},
                   {"number", section.value("number", "")}});
  }
  return toc;
}

}  // namespace

std::vector<fs::path> page_libraries() {
  return {kCharts, kChartStyle, kThree, kOrbit};
}

std::string html_page(const std::string& name, PageData data) {
  mustache::data page = for_templates(data);
  for (const char* one : kTemplates) {
    const fs::path file = part(one + std::string(".mustache"));
    std::string text = bytes_of(file);
    const mustache::mustache sheet(text);
    if (!sheet.is_valid()) throw std::runtime_error(file.string() + ": " + sheet.error_message());
    page.set(one, mustache::data(mustache::partial([text] { return text; })));
  }
  page.set("toc", for_templates(contents_of(data)));

  bool has_charts = false;
  bool has_replays = false;
  take_apart(data, has_charts, has_replays);
  std::vector<std::string> scripts;
  std::string style = css_of_lines() + bytes_of(part("page.css"));
  const auto add = [&scripts](const fs::path& file) { scripts.push_back(bytes_of(file)); };
  if (has_replays) {
    add(kThree);
    add(kOrbit);
    style += bytes_of(part("replay/replay.css"));
  }
  if (has_charts) {
    add(kCharts);
    style = bytes_of(kChartStyle) + style;
  }
  add(part("page.js"));
  if (has_replays) {
    for (const char* script : {"data", "shapes", "shading", "scene", "view"}) {
      add(part(std::string("replay/") + script + ".js"));
    }
  }
  page.set("has_charts", has_charts);
  page.set("has_replays", has_replays);
  page.set("style", style);
  PageData result = {{"page", name}, {"version", 1}};
  result.update(data);
  // The page's loader unpacks the scripts, in their order, and the data.
  const std::string json = PageData{{"scripts", scripts}, {"result", result}}.dump(
      -1, ' ', false, PageData::error_handler_t::replace);
  page.set("packed",
           packed_bytes({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()}));
  page.set("script", bytes_of(part("unpack.js")));
  page.set("contents_script", bytes_of(part("contents.js")));
  page.set("version", std::string(kVersion) + " (" + kGitCommit + ")");
  return mustache::mustache("{{>page}}").render(page);
}

std::string text_of(const PageData& value) {
  if (value.is_object()) return text_of(value.at("value"));
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.is_null() ? "-" : value.dump();
  const double number = value.get<double>();
  return std::isfinite(number) ? in_digits(number) : "-";
}

std::string printed_table(const PageData& table, std::size_t width) {
  const auto texts = [](const PageData& cells) {
    std::vector<std::string> all;
    for (const PageData& cell : cells) all.push_back(text_of(cell));
    return all;
  };
  TextRows rows = {texts(table["columns"])};
  for (const PageData& row : table["rows"]) rows.push_back(texts(row));
  return in_columns(std::move(rows), width);
}

std::string anchor(const std::string& text) {
  std::string clean = text;
  for (char& c : clean) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  }
  return clean;
}

std::string series_class(LineStyle style) {
  return fmt::format("c{} d{}", colour_number(style), dash_number(style));
}

// NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)
}  // namespace breakwater
