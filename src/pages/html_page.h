// A page in one file, with its styles, scripts, charts, pictures and videos.
#pragma once

#include <filesystem>
#include <kainjow/mustache.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <breakwater/pages/page_chart.h>

namespace breakwater {

/// Kind of the charts of a page. `over_time`: signals that dygraphs draws when they scroll into
/// view. `drawn`: SVG in the page, with a style data/report/NAME.css and possibly a script NAME.js.
enum class PageCharts { over_time, drawn };

/// Renders `data` with the template data/report/NAME.mustache into the common page. The common page
/// needs "title", "toc" (a list of "href" and "label") and "lead" in `data`. The page allows no
/// network request. Throws std::runtime_error if a template is missing or damaged.
std::string html_page(const std::string& name, kainjow::mustache::data& data,
                      PageCharts charts = PageCharts::over_time);

/// The files of other projects that go into the pages, each one as a whole.
std::vector<std::filesystem::path> page_libraries();

/// The data of a chart for the templates.
kainjow::mustache::data chart_data(const PageChart& chart);

/// JSON that is safe inside <script>. Invalid UTF-8 is replaced.
std::string script_json(const nlohmann::ordered_json& json);

/// The bytes of a file as a data: address. Empty if there is no such file.
std::string data_address(const std::filesystem::path& file, const std::string& type);

/// A number as text: "5.02", "1.1e-13"; "never" if infinite, "not measured" if NaN.
std::string format_number(double value);

/// A text as part of an address: '-' replaces all characters except letters, digits and '-'.
std::string anchor(const std::string& text);

}  // namespace breakwater
