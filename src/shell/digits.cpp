#include <breakwater/shell/digits.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

namespace breakwater {
namespace {

int digits = 4;

}  // namespace

CLI::Option* add_digits(CLI::App& app) {
  return app
      .add_option("--digits", digits, "significant digits of printed numbers; files have all")
      ->type_name("N")
      ->check(CLI::Range(1, 17))
      ->capture_default_str();
}

int shown_digits() {
  return digits;
}

std::string in_digits(double value) {
  constexpr double kLargestWhole = 1e9;
  const bool is_whole = std::abs(value) < kLargestWhole && value == std::round(value);
  if (is_whole) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace breakwater
