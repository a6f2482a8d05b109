#include <breakwater/report/html_page.h>

#include <cctype>
#include <stdexcept>

#include <breakwater/report/file_bytes.h>
#include <breakwater/scenario/paths.h>
#include <breakwater/version.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace mustache = kainjow::mustache;
namespace {

fs::path part(const std::string& name) {
  return data_file("data/report/" + name);
}

std::string fill_in(const fs::path& file, const mustache::data& data) {
  mustache::mustache sheet(bytes_of(file));
  if (!sheet.is_valid()) throw std::runtime_error(file.string() + ": " + sheet.error_message());
  return sheet.render(data);
}

}  // namespace

std::string html_page(const std::string& name, mustache::data& data) {
  std::string chart = bytes_of(part("chart.mustache"));
  data.set("chart", mustache::data(mustache::partial([chart] { return chart; })));
  mustache::data page = data;
  page.set("content", fill_in(part(name + ".mustache"), data));
  page.set("style", bytes_of(fs::path(BREAKWATER_DYGRAPHS) / "dygraph.min.css") +
                        bytes_of(part("page.css")));
  page.set("dygraphs", bytes_of(fs::path(BREAKWATER_DYGRAPHS) / "dygraph.min.js"));
  page.set("script", bytes_of(part("page.js")));
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

std::string data_address(const fs::path& file, const std::string& type) {
  if (!fs::exists(file)) return "";
  const std::string bytes = bytes_of(file);
  return "data:" + type + ";base64," + base64(bytes.data(), bytes.size());
}

std::string anchor(const std::string& text) {
  std::string clean = text;
  for (char& c : clean) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  }
  return clean;
}

}  // namespace breakwater
