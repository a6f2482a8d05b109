#include <breakwater/pages/html_page.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/pictures/page_data.h>
#include <breakwater/record/file_bytes.h>
#include <breakwater/shell/paths.h>
#include <breakwater/version.h>

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
  page.set("content", fill_in(part(name + ".mustache"), data));
  const std::string own = bytes_of(part("page.css"));
  if (charts == PageCharts::over_time) {
    page.set("has_charts", true);
    page.set("dygraphs", bytes_of(kCharts));
    page.set("style", bytes_of(kChartStyle) + own);
    page.set("script", bytes_of(part("page.js")));
  } else {
    page.set("style", own + bytes_of(part("drawn.css")) + bytes_of(part(name + ".css")));
    const fs::path shared = part("drawn.js"), of_page = shared.parent_path() / (name + ".js");
    page.set("script", bytes_of(shared) + (fs::exists(of_page) ? bytes_of(of_page) : ""));
  }
  if (data.get("has_replays") != nullptr) {
    page.set("three", bytes_of(kThree) + bytes_of(kOrbit));
    std::string viewer;
    for (const char* script : {"data", "shapes", "shading", "scene", "view"}) {
      viewer += bytes_of(part(std::string("replay/") + script + ".js"));
    }
    page.set("viewer", viewer);
    page.set("replay_style", bytes_of(part("replay/replay.css")));
  }
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
