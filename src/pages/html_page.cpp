#include <breakwater/pages/html_page.h>

#include <fmt/format.h>

#include <cctype>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/experiment/version.h>
#include <breakwater/pictures/page_data.h>
#include <breakwater/record/file_bytes.h>
#include <breakwater/render/identity.h>
#include <breakwater/shell/paths.h>

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

std::string fill_in(const fs::path& file, const mustache::data& data) {
  mustache::mustache sheet(bytes_of(file));
  if (!sheet.is_valid()) throw std::runtime_error(file.string() + ": " + sheet.error_message());
  return sheet.render(data);
}

// The identities' colours and dashes as a style: c0 …, d0 …, and the same as --c0 …, --d0 … for
// scripts. The last of each are references'.
std::string identity_style() {
  std::string light, dark, classes;
  for (int k = 0; k <= kIdentityColours; ++k) {
    const Identity identity = k < kIdentityColours ? k : kReferenceIdentity;
    light += fmt::format("--c{}:{};", k, light_colour(identity));
    dark += fmt::format("--c{}:{};", k, dark_colour(identity));
    classes += fmt::format(".c{0}{{--c:var(--c{0})}}\n", k);
    // Each of the first ones has the dash with its own number.
    std::string strip, lengths;
    double at = 0.0;
    bool is_stroke = false;
    for (const double length : dashes(identity)) {
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

// Takes the data of charts and replays out of a page, as one JSON object by their ids.
std::string taken_data(std::string& content) {
  const std::string begin = "<script type=\"application/json\" id=\"", end = "</script>";
  std::string all;
  for (std::size_t at = content.find(begin); at != std::string::npos;
       at = content.find(begin, at)) {
    const std::size_t id = at + begin.size();
    const std::size_t quote = content.find('"', id);
    const std::size_t stop = content.find(end, quote);
    all += fmt::format("{}\"{}\":{}", all.empty() ? "" : ",", content.substr(id, quote - id),
                       content.substr(quote + 2, stop - quote - 2));
    content.erase(at, stop + end.size() - at);
  }
  return "{" + all + "}";
}

// The scripts of a page in their order, and its data: its loader unpacks them.
std::string packed_page(const nlohmann::json& scripts, const std::string& data) {
  const std::string json =
      fmt::format("{{\"scripts\":{},\"data\":{}}}",
                  scripts.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), data);
  return packed_bytes({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
}

}  // namespace

std::vector<fs::path> page_libraries() {
  return {kCharts, kChartStyle, kThree, kOrbit};
}

std::string html_page(const std::string& name, mustache::data& data, PageCharts charts) {
  for (const std::string partial :
       {"chart", "study_metric", "replay_box", "changed_keys", "window_button"}) {
    data.set(partial, mustache::data(mustache::partial(
                          [text = bytes_of(part(partial + ".mustache"))] { return text; })));
  }
  mustache::data page = data;
  std::string content = fill_in(part(name + ".mustache"), data);
  const std::string own = identity_style() + bytes_of(part("page.css"));
  const bool has_replays = data.get("has_replays") != nullptr;
  if (charts == PageCharts::over_time) {
    page.set("has_charts", true);
    page.set("style", bytes_of(kChartStyle) + own);
    nlohmann::json scripts = {bytes_of(kCharts), bytes_of(part("page.js"))};
    if (has_replays) {
      scripts.insert(scripts.begin(), {bytes_of(kThree), bytes_of(kOrbit)});
      for (const char* script : {"data", "shapes", "shading", "scene", "view"}) {
        scripts.push_back(bytes_of(part(std::string("replay/") + script + ".js")));
      }
      page.set("replay_style", bytes_of(part("replay/replay.css")));
    }
    page.set("packed", packed_page(scripts, taken_data(content)));
    page.set("script", bytes_of(part("unpack.js")));
  } else {
    page.set("style", own + bytes_of(part("drawn.css")) + bytes_of(part(name + ".css")));
    const fs::path shared = part("drawn.js"), of_page = shared.parent_path() / (name + ".js");
    page.set("script", bytes_of(shared) + (fs::exists(of_page) ? bytes_of(of_page) : ""));
  }
  page.set("content", content);
  page.set("contents_script", bytes_of(part("contents.js")));
  page.set("version", std::string(kVersion) + " (" + kGitCommit + ")");
  return fill_in(part("page.mustache"), page);
}

mustache::data chart_data(const PageChart& chart) {
  mustache::data data;
  data.set("id", chart.id);
  data.set("group", chart.group);
  data.set("axis", chart.axis.empty() ? chart.group : chart.axis);
  data.set("heading", chart.axis_title());
  data.set("alt", chart.alternative_text());
  data.set("json", chart.json());
  return data;
}

std::string script_json(const nlohmann::ordered_json& json) {
  return script_safe(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::string data_address(const fs::path& file, const std::string& type) {
  if (!fs::exists(file)) return "";
  const std::string bytes = bytes_of(file);
  return "data:" + type + ";base64," + base64(bytes.data(), bytes.size());
}

std::string format_number(double value) {
  if (std::isnan(value)) return "not measured";
  if (std::isinf(value)) return "never";
  const double size = std::abs(value);
  constexpr double kLongestCount = 1e7;
  if (value == std::round(value) && size < kLongestCount) return fmt::format("{:.0f}", value);
  if (size < 1e-3 || size >= 1e5) return fmt::format("{:.2e}", value);
  return size < 1e3 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string anchor(const std::string& text) {
  std::string clean = text;
  for (char& c : clean) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  }
  return clean;
}

}  // namespace breakwater
