// A page in one file: styles, scripts, charts, pictures and videos are all in it.
#pragma once

#include <filesystem>
#include <kainjow/mustache.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <breakwater/pages/page_chart.h>

namespace breakwater {

/// What a page's charts are: of signals over time, drawn by dygraphs when they come into view; or
/// drawings that are in the page, with a style of its own, data/report/NAME.css, and a script
/// NAME.js where there is one.
enum class PageCharts { over_time, drawn };

/// `data` in the template data/report/NAME.mustache, put into the common page. `data` has what
/// the page needs besides: "title", "toc" (a list of "href", "label"), "lead". The page allows no
/// request whatever. Throws std::runtime_error if a template is missing or damaged.
std::string html_page(const std::string& name, kainjow::mustache::data& data,
                      PageCharts charts = PageCharts::over_time);

/// The files of other projects that pages need, each of which goes into a page whole.
std::vector<std::filesystem::path> page_libraries();

/// What the templates call a chart.
kainjow::mustache::data chart_data(const PageChart& chart);

/// JSON that can stand within <script>: what is no UTF-8 is replaced.
std::string script_json(const nlohmann::ordered_json& json);

/// A file's bytes as a data: address. Empty if there is no such file.
std::string data_address(const std::filesystem::path& file, const std::string& type);

/// "5.02", "1.1e-13"; "never" for an infinite one, "not measured" for NaN.
std::string format_number(double value);

/// A text as part of an address: all but letters, digits and '-' become '-'.
std::string anchor(const std::string& text);

}  // namespace breakwater
