// Values and files from the bytes of a fuzzer, and the parsers of a target.
#pragma once

#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace breakwater::fuzz {

/// Takes values from the bytes; zeros when none are left.
class Input {
 public:
  explicit Input(std::string_view bytes) : bytes_(bytes) {}

  bool is_empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (is_empty()) return 0;
    const auto first = static_cast<std::uint8_t>(bytes_.front());
    bytes_.remove_prefix(1);
    return first;
  }

  /// A whole number from 0 to `last`.
  int whole(int last) { return byte() % (last + 1); }

  /// A small number, a number of any size, infinity or NaN. One byte is enough for the first kind,
  /// so short inputs make ordinary problems.
  double number() {
    const int kind = byte();
    if (kind < 240) return (kind - 120) / 16.0;
    if (kind == 240) return std::numeric_limits<double>::quiet_NaN();
    if (kind == 241) return std::numeric_limits<double>::infinity();
    if (kind == 242) return -std::numeric_limits<double>::infinity();
    if (kind < 248) return std::ldexp((byte() - 128) / 16.0, (byte() - 128) * 8);
    std::uint8_t bytes[sizeof(double)];
    for (std::uint8_t& one : bytes) one = byte();
    double value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }

  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd values(rows, columns);
    for (double& value : values.reshaped()) value = number();
    return values;
  }
  Eigen::VectorXd vector(Eigen::Index size) { return matrix(size, 1); }

  /// Often symmetric and positive definite, otherwise any matrix.
  Eigen::MatrixXd weight(Eigen::Index size) {
    const int kind = whole(3);
    const Eigen::MatrixXd root = matrix(size, size);
    if (kind == 0) return root;
    if (kind == 1) return root * root.transpose();
    return root * root.transpose() + Eigen::MatrixXd::Identity(size, size);
  }

 private:
  std::string_view bytes_;
};

/// A folder in memory that the process removes.
class Folder {
 public:
  Folder() {
    char name[] = "/dev/shm/breakwater-fuzz-XXXXXX";
    if (mkdtemp(name) == nullptr) __builtin_trap();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const { return path_; }

  /// Replaces a file and returns its path.
  std::string write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path file = path_ / name;
    std::FILE* const stream = std::fopen(file.c_str(), "wb");
    if (stream == nullptr) __builtin_trap();
    std::fwrite(bytes.data(), 1, bytes.size(), stream);
    std::fclose(stream);
    return file.string();
  }

 private:
  std::filesystem::path path_;
};

/// The path of a file in memory with this text. It replaces the one before.
inline std::string file_with(std::string_view text) {
  static const int descriptor = memfd_create("fuzz", MFD_CLOEXEC);
  const bool is_written =
      ftruncate(descriptor, 0) == 0 &&
      pwrite(descriptor, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!is_written) __builtin_trap();
  return "/proc/self/fd/" + std::to_string(descriptor);
}

/// A folder of the process.
inline const Folder& folder() {
  static const Folder made;
  return made;
}

/// Ends the process with a message: a broken property is a finding, as a crash is.
inline void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", property);
  __builtin_trap();
}

/// Counts an execution of a parser. At the end of the process all counts are printed:
/// `executed NAME COUNT`.
inline void count(const std::string& parser) {
  struct Counts {
    std::map<std::string, long> of;
    ~Counts() {
      for (const auto& [name, number] : of) {
        std::fprintf(stderr, "executed %s %ld\n", name.c_str(), number);
      }
    }
  };
  static Counts counts;
  ++counts.of[parser];
}

/// One of the parsers of a target. The first byte of an input selects it, and the rest is its text.
struct Parser {
  char letter;
  const char* name;
  void (*read)(const std::string& text);
};

/// Calls the selected parser. It may refuse the text by std::invalid_argument. With
/// BREAKWATER_PARSER=LETTER other parsers do nothing, so libFuzzer keeps no input for them.
inline int run_selected(std::span<const Parser> parsers, const std::uint8_t* data,
                        std::size_t size) {
  static const char* const only = std::getenv("BREAKWATER_PARSER");
  if (size == 0 || (only != nullptr && static_cast<char>(data[0]) != *only)) return 0;
  for (const Parser& parser : parsers) {
    if (parser.letter != static_cast<char>(data[0])) continue;
    count(parser.name);
    try {
      parser.read({reinterpret_cast<const char*>(data + 1), size - 1});
    } catch (const std::invalid_argument&) {
      // refused
    }
  }
  return 0;
}

/// The parts of a text between zero bytes.
inline std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts(1);
  for (const char letter : text) {
    if (letter == '\0') {
      parts.emplace_back();
    } else {
      parts.back() += letter;
    }
  }
  return parts;
}

}  // namespace breakwater::fuzz
