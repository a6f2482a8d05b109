// Helpers that many tests share.
#pragma once

#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <complex>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace breakwater::testing {

/// A fixed sequence of random numbers: a test fails always or never.
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

/// Removes a file or folder at the end of its scope.
class Removed {
 public:
  explicit Removed(std::filesystem::path path) : path_(std::move(path)) {}
  Removed(const Removed&) = delete;
  Removed& operator=(const Removed&) = delete;
  ~Removed() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

 private:
  std::filesystem::path path_;
};

/// A file of the project.
std::string source_file(const std::string& relative);

/// All of a file.
std::string text_of(const std::filesystem::path& file);

/// The folder of the built programs.
std::filesystem::path bin_folder();

}  // namespace breakwater::testing
