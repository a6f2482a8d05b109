// How many digits numbers have that a terminal shows.
#pragma once

#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace breakwater {

/// Adds --digits, which holds for the process.
CLI::Option* add_digits(CLI::App& app);

/// Four, or as many as --digits says.
int shown_digits();

/// A number with so many significant digits, a whole one below 1e9 with all. Files have all digits.
std::string in_digits(double value);

}  // namespace breakwater
