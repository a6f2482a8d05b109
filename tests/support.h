// Common header of all tests: GoogleTest, the usual standard headers, and helpers.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// The call throws std::invalid_argument.
#define EXPECT_REFUSED(...) EXPECT_THROW((__VA_ARGS__), std::invalid_argument)

namespace breakwater::testing {

/// A fixed sequence of random numbers, so that a test always gives the same result.
class Random {
 public:
  explicit Random(unsigned seed = 1) : engine_(seed) {}

  double uniform(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [this] { return uniform(-1.0, 1.0); });
  }
  Eigen::VectorXd vector(Eigen::Index size, double bound = 1.0) {
    return Eigen::VectorXd::NullaryExpr(size, [this, bound] { return uniform(-bound, bound); });
  }

 private:
  std::mt19937_64 engine_;
};

/// The number of random inputs of a property: BREAKWATER_PROPERTIES, or a few for CI. Throws
/// std::invalid_argument if it is no positive number.
int property_count(int in_ci);

/// The largest distance between the members of two sets of complex numbers, matched in order.
inline double distance(std::vector<std::complex<double>> a, std::vector<std::complex<double>> b) {
  const auto before = [](const auto& x, const auto& y) {
    return std::abs(x.real() - y.real()) > 1e-7 ? x.real() < y.real() : x.imag() < y.imag();
  };
  std::sort(a.begin(), a.end(), before);
  std::sort(b.begin(), b.end(), before);
  double largest = a.size() == b.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

/// Products of a Kalman filter, compiled once: A P Aᵀ, and P Cᵀ (C P Cᵀ + R)⁻¹.
Eigen::MatrixXd congruence(const Eigen::MatrixXd& A, const Eigen::MatrixXd& P);
Eigen::MatrixXd kalman_gain(const Eigen::MatrixXd& P, const Eigen::MatrixXd& C,
                            const Eigen::MatrixXd& R);

/// The middle value, or the mean of the two middle ones.
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// A file name that no other running test uses.
inline std::filesystem::path temporary_path(const std::string& name) {
  return std::filesystem::temp_directory_path() /
         ("breakwater_test_" + std::to_string(getpid()) + "_" + name);
}

/// A file or folder at a temporary_path(), which is removed at the end of its scope.
class TemporaryPath : public std::filesystem::path {
 public:
  explicit TemporaryPath(const std::string& name) : path(temporary_path(name)) {}
  /// Makes the file.
  TemporaryPath(const std::string& name, const std::string& text) : TemporaryPath(name) {
    std::ofstream(*this, std::ios::binary) << text;
  }
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  ~TemporaryPath() {
    std::error_code ignored;
    std::filesystem::remove_all(*this, ignored);
  }
};

/// The path of a project's file.
std::string source_file(const std::string& relative);

/// The contents of a file.
std::string text_of(const std::filesystem::path& file);

std::vector<std::string> lines_of(const std::string& text);

/// The number of the line with the first `part`. Throws std::logic_error if there is none.
std::string line_of(const std::string& text, const std::string& part);

/// Whether `text` has all parts, or none of them. EXPECT_TRUE prints the exceptions.
::testing::AssertionResult has_all(const std::string& text, const std::vector<std::string>& parts);
::testing::AssertionResult lacks_all(const std::string& text,
                                     const std::vector<std::string>& parts);
template <typename... Parts>
::testing::AssertionResult has(const std::string& text, const Parts&... parts) {
  return has_all(text, {parts...});
}
template <typename... Parts>
::testing::AssertionResult lacks(const std::string& text, const Parts&... parts) {
  return lacks_all(text, {parts...});
}

/// The text with its first `from` replaced. Throws std::logic_error if it has none.
std::string replaced(std::string text, const std::string& from, const std::string& to);

/// A text repeated `times` times.
std::string repeated(const std::string& text, int times);

/// The message of the Error that a call throws; "" if it throws none.
template <typename Error = std::invalid_argument, typename Call>
std::string complaint_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// The folder of the built programs.
std::filesystem::path bin_folder();

}  // namespace breakwater::testing

namespace breakwater {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
using testing::complaint_of;
using testing::has;
using testing::lacks;
}  // namespace breakwater
