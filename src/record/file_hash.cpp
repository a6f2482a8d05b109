#include <breakwater/record/file_hash.h>

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

constexpr std::size_t kBlock = 1 << 16;

// XXH3 (64 bits) of several pieces.
class BlockHash {
 public:
  BlockHash() : state_(XXH3_createState(), [](XXH3_state_t* state) { XXH3_freeState(state); }) {
    XXH3_64bits_reset(state_.get());
  }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state_.get(), data, bytes); }
  std::uint64_t digest() const { return XXH3_64bits_digest(state_.get()); }

 private:
  std::unique_ptr<XXH3_state_t, void (*)(XXH3_state_t*)> state_;
};

}  // namespace

std::string file_hash(const std::filesystem::path& file) {
  std::ifstream stream = open_input(file);
  BlockHash hash;
  std::vector<char> block(kBlock);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof()) {
    throw std::invalid_argument(file.string() + ": cannot be read");
  }
  return fmt::format("{:016x}", hash.digest());
}

std::string text_hash(std::string_view text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

std::string fingerprint(const std::vector<std::string>& parts) {
  BlockHash hash;
  for (const std::string& part : parts) {
    const std::string size = std::to_string(part.size()) + ":";
    hash.add(size.data(), size.size());
    hash.add(part.data(), part.size());
  }
  return fmt::format("{:016x}", hash.digest());
}

}  // namespace breakwater
