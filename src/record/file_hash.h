// Hashes of files and texts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct XXH3_state_s;

namespace breakwater {

/// XXH3 (64 bits) of several pieces. Only the constructor allocates.
class BlockHash {
 public:
  BlockHash();
  /// Begins again.
  void reset();
  void add(const void* data, std::size_t bytes);
  std::uint64_t digest() const;

 private:
  std::unique_ptr<XXH3_state_s, void (*)(XXH3_state_s*)> state_;
};

/// 16 hexadecimal digits: XXH3 (64 bits) of the file's bytes. Throws std::invalid_argument
/// `FILE: cannot be read`.
std::string file_hash(const std::filesystem::path& file);

/// The same for a text.
std::string text_hash(std::string_view text);

/// 16 hexadecimal digits that change with any of `parts`.
std::string fingerprint(const std::vector<std::string>& parts);

}  // namespace breakwater
