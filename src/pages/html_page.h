// A page in one file, with its styles, scripts, charts, pictures and videos.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <breakwater/render/identity.h>

namespace breakwater {

/// The content of a page, as one JSON (docs/explanation/decisions/0023-a-page-is-data.md). The page
/// has it, packed, and shows it without scripts too, its charts apart.
using PageData = nlohmann::ordered_json;

/// Draws `data` with data/report/NAME.mustache, or result.mustache if that is not there, in the
/// common page. `data` has "title" and either "sections", each with "id" and "heading", or "toc", a
/// list of "href" and "label". A template gets a value as text_of() it, and has_NAME of a list. A
/// list in a list is a row of cells for it, and an empty text is not there. The scripts get no
/// picture, no video, and no "machine" or "pages"; the templates get no "data". The page allows no
/// network request. Throws std::runtime_error if a template is missing or damaged.
std::string html_page(const std::string& name, PageData data);

/// The files of other projects that go into the pages, each one as a whole.
std::vector<std::filesystem::path> page_libraries();

/// The bytes of a file as a data: address. Empty if there is no such file.
std::string data_address(const std::filesystem::path& file, const std::string& type);

/// A number as text: "5.02", "1.1e-13"; "never" if infinite, "not measured" if NaN.
std::string format_number(double value);

/// A value of the data as text: a number in digits (shell/digits.h), "-" where there is none.
std::string text_of(const PageData& value);

/// A table of the data for the terminal.
std::string printed_table(const PageData& table, std::size_t width);

/// A text as part of an address: '-' replaces all characters except letters, digits and '-'.
std::string anchor(const std::string& text);

/// The classes of an identity's colour and dash.
std::string series_class(Identity identity);

}  // namespace breakwater
