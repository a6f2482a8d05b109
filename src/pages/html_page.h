// A page in one file, with its styles, scripts, charts and pictures.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <breakwater/render/line_style.h>

namespace breakwater {

/// The content of a page, as one JSON (docs/explanation/decisions/0023-a-page-is-data.md). The page
/// has it, packed, and shows it without scripts too, its charts apart.
using PageData = nlohmann::ordered_json;

/// Appends a block to a list of them: {KIND: value}.
inline void add_block(PageData& blocks, const char* kind, PageData value) {
  blocks.push_back(PageData{{kind, std::move(value)}});
}

/// Appends a section to a list of them.
inline void add_section(PageData& sections, const std::string& id, const std::string& heading,
                        PageData blocks) {
  sections.push_back({{"id", id}, {"heading", heading}, {"blocks", std::move(blocks)}});
}

/// Draws `data`, the page of the command `name`, with data/report/page.mustache. It has "title" and
/// "sections", and may have "toc", a list of "href" and "label", if the contents are not the
/// sections' headings. The templates get a value as text_of() it, and has_NAME of a list. A list in
/// a list is a row of cells for them; "data" and empty texts are not there. The scripts get no
/// picture and no "machine". The page allows no network request. Throws
/// std::runtime_error if a template is missing or damaged.
std::string html_page(const std::string& name, PageData data);

/// The files of other projects that go into the pages, each one as a whole.
std::vector<std::filesystem::path> page_libraries();

/// A value of the data as text: a number in digits (in_digits), "-" where there is none.
std::string text_of(const PageData& value);

/// A table of texts. The first row has the columns.
inline PageData text_table(const char* label, const std::vector<std::vector<std::string>>& rows) {
  return {{"label", label},
          {"columns", rows.front()},
          {"rows", std::vector(rows.begin() + 1, rows.end())}};
}

/// A table of the data for the terminal.
std::string printed_table(const PageData& table, std::size_t width);

/// A text as part of an address: '-' replaces all characters except letters, digits and '-'.
std::string anchor(const std::string& text);

/// The classes of a style's colour and dash.
std::string series_class(LineStyle style);

}  // namespace breakwater
