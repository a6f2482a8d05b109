#include "support.h"

#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

namespace breakwater::testing {

std::string source_file(const std::string& relative) {
  return std::string(BREAKWATER_SOURCE_DIR) + "/" + relative;
}

int property_count(int in_ci) {
  const char* const given = std::getenv("BREAKWATER_PROPERTIES");
  if (given == nullptr) return in_ci;
  const std::string text = given;
  int count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count < 1)
    throw std::invalid_argument("BREAKWATER_PROPERTIES: must be a positive number");
  return count;
}

Eigen::MatrixXd congruence(const Eigen::MatrixXd& A, const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd half = A * P;
  return half * A.transpose();
}

Eigen::MatrixXd kalman_gain(const Eigen::MatrixXd& P, const Eigen::MatrixXd& C,
                            const Eigen::MatrixXd& R) {
  const Eigen::MatrixXd half = P * C.transpose(), S = C * half + R;
  return half * S.inverse();
}

std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

::testing::AssertionResult has_all(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) != std::string::npos) continue;
    return ::testing::AssertionFailure() << '"' << part << "\" is not in: " << text.substr(0, 4000);
  }
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult lacks_all(const std::string& text,
                                     const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    const auto at = text.find(part);
    if (at == std::string::npos) continue;
    return ::testing::AssertionFailure() << '"' << part << "\" is in: " << text.substr(at, 400);
  }
  return ::testing::AssertionSuccess();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error(from + ": is not there");
  return text.replace(at, from.size(), to);
}

std::string line_of(const std::string& text, const std::string& part) {
  const auto at = text.find(part);
  if (at == std::string::npos) throw std::logic_error(part + ": is not there");
  return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::filesystem::path bin_folder() {
  return BREAKWATER_BIN_DIR;
}

}  // namespace breakwater::testing
