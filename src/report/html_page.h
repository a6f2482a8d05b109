// A page in one file: styles, scripts, charts, pictures and videos are all in it.
#pragma once

#include <filesystem>
#include <kainjow/mustache.hpp>
#include <string>

#include <breakwater/report/page_chart.h>

namespace breakwater {

/// `data` in the template data/report/TEMPLATE.mustache, put into the common page. `data` has what
/// the page needs besides: "title", "toc" (a list of "href", "label"), "lead". The page allows no
/// request whatever. Throws std::runtime_error if a template is missing or damaged.
std::string html_page(const std::string& name, kainjow::mustache::data& data);

/// What the templates call a chart.
kainjow::mustache::data chart_data(const PageChart& chart);

/// A file's bytes as a data: address. Empty if there is no such file.
std::string data_address(const std::filesystem::path& file, const std::string& type);

/// A text as part of an address: all but letters, digits and '-' become '-'.
std::string anchor(const std::string& text);

}  // namespace breakwater
