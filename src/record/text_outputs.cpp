#include <breakwater/record/text_outputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

namespace breakwater {

void write_text_file(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) {
    throw OutputError(file + ": cannot be written (" + std::generic_category().message(errno) +
                      ")");
  }
}

void write_csv_log(const std::string& file, const Track& track) {
  std::string text = "time_s";
  for (std::size_t i = 0; i < track.signals(); ++i) {
    const Signal& signal = track.signal(i);
    if (signal.values.size() == 1) {
      text += "," + signal.name;
    } else {
      for (std::size_t k = 1; k <= signal.values.size(); ++k) {
        fmt::format_to(std::back_inserter(text), ",{}_{}", signal.name, k);
      }
    }
  }
  text += '\n';
  for (std::size_t i = 0; i < track.rows(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}", track.times()[i]);
    for (std::size_t k = 0; k < track.signals(); ++k) {
      const std::size_t width = track.signal(k).values.size();
      fmt::format_to(std::back_inserter(text), ",{}",
                     fmt::join(track.values(k).subspan(i * width, width), ","));
    }
    text += '\n';
  }
  write_text_file(file, text);
}

void write_metrics(const std::string& file, const std::vector<Metric>& metrics) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const Metric& metric : metrics) {
    if (std::isfinite(metric.value)) json[metric.name] = metric.value;
  }
  write_text_file(file, json.dump(2) + "\n");
}

bool is_column_name(const std::string& name) {
  const auto is_plain = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_plain);
}

std::string csv_text(const std::string& text) {
  const bool is_formula = text.find_first_of("=+-@\t\r") == 0;
  return is_formula ? "'" + text : text;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (!line.empty() || &cell != &cells.front()) line += ',';
    if (cell.find_first_of(",\"\n") == std::string::npos) {
      line += cell;
      continue;
    }
    line += '"';
    for (const char c : cell) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

}  // namespace breakwater
