#include <breakwater/config/toml_entry.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/config/fields.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {

TomlEntry::TomlEntry(const toml::table& root, std::string file, OptionName option)
    : node_(&root), source_(&root.source()), file_(std::move(file)), option_(option) {}

TomlEntry TomlEntry::with(const toml::node* node, const toml::source_region& source,
                          std::string key) const {
  TomlEntry entry = *this;
  entry.node_ = node;
  entry.source_ = &source;
  entry.key_ = std::move(key);
  return entry;
}

std::string TomlEntry::place() const {
  if (!source_->path && option_ != nullptr) return option_(key_);
  const std::string where = has_line_ ? at_line(file_, *source_) : file_;
  return key_.empty() ? where : where + ": " + key_;
}

void TomlEntry::fail(const std::string& reason) const {
  throw std::invalid_argument(place() + ": " + reason);
}

const toml::table* TomlEntry::table() const {
  if (node_ != nullptr && !node_->is_table()) fail("must be a table");
  return node_ == nullptr ? nullptr : node_->as_table();
}

TomlEntry TomlEntry::operator[](const std::string& key) const {
  const toml::table* const from = table();
  const toml::node* const node = from == nullptr ? nullptr : from->get(key);
  TomlEntry entry = with(node, node == nullptr ? *source_ : node->source(),
                         key_.empty() ? key : key_ + "." + key);
  entry.has_line_ = node != nullptr || (from != nullptr && !key_.empty());
  return entry;
}

std::vector<std::pair<std::string, TomlEntry>> TomlEntry::entries() const {
  std::vector<std::pair<std::string, TomlEntry>> all;
  if (const toml::table* const from = table()) {
    for (const auto& [key, node] : *from) {
      const std::string name(key.str());
      all.emplace_back(name, (*this)[name]);
      all.back().second.begin_ = key.source().begin;
    }
  }
  // The TOML parser sorts tables by name.
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.second.begin_ < b.second.begin_; });
  return all;
}

void TomlEntry::allow(const std::vector<std::string>& keys) const {
  for (const auto& [key, entry] : entries()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    constexpr std::size_t kFew = 4;
    entry.fail("unknown key" +
               (keys.size() <= kFew ? did_you_mean_or_list : did_you_mean)(key, keys));
  }
}

std::vector<TomlEntry> TomlEntry::elements() const {
  std::vector<TomlEntry> all;
  if (node_ == nullptr) return all;
  if (!node_->is_array()) fail("must be an array");
  for (const toml::node& element : *node_->as_array()) {
    all.push_back(with(&element, element.source(), key_));
  }
  return all;
}

std::string TomlEntry::text_or_nothing() const {
  return node_ == nullptr ? "" : text();
}

std::string TomlEntry::text_or_empty() const {
  if (node_ == nullptr) return "";
  if (!node_->is_string()) fail("must be a text");
  return node_->as_string()->get();
}

std::string TomlEntry::text() const {
  if (node_ == nullptr) fail("is missing");
  std::string text = text_or_empty();
  if (text.empty()) fail("must be a text, is empty");
  return text;
}

std::vector<std::string> TomlEntry::texts() const {
  if (node_ == nullptr) return {};
  if (!node_->is_array()) return {text()};
  std::vector<std::string> all;
  for (const TomlEntry& element : elements()) {
    all.push_back(element.text());
    if (std::count(all.begin(), all.end(), all.back()) > 1) fail(all.back() + " is there twice");
  }
  if (all.empty()) fail("is empty");
  return all;
}

std::int64_t TomlEntry::whole(std::int64_t lower, std::int64_t upper) const {
  if (node_ == nullptr) fail("is missing");
  const auto* integer = node_->as_integer();
  if (integer == nullptr || integer->get() < lower || integer->get() > upper) {
    fail(fmt::format("must be a whole number of {} to {}", lower, upper));
  }
  return integer->get();
}

double TomlEntry::number() const {
  if (node_ == nullptr) fail("is missing");
  const auto number = node_->is_number() ? node_->value<double>() : std::nullopt;
  if (!number || !std::isfinite(*number)) fail("must be a number");
  return *number;
}

double TomlEntry::number(const Range& range) const {
  const double value = number();
  if (!range.contains(value)) fail(fmt::format("must be {}, is {}", range.text, value));
  return value;
}

std::optional<double> TomlEntry::number_or_nothing() const {
  return *this ? std::optional(number()) : std::nullopt;
}

std::size_t TomlEntry::choice_of(const std::vector<std::string>& names) const {
  const std::string name = text();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) fail(must_be_one_of(names, name));
  return static_cast<std::size_t>(found - names.begin());
}

std::string TomlEntry::written() const {
  return toml_value(config_value(*node_, place()));
}

}  // namespace breakwater
