#include <breakwater/record/file_hash.h>

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

constexpr std::size_t kBlock = 1 << 16;

}  // namespace

std::string file_hash(const std::filesystem::path& file) {
  std::ifstream stream = open_input(file);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> hash(XXH3_createState(),
                                                                      XXH3_freeState);
  XXH3_64bits_reset(hash.get());
  std::vector<char> block(kBlock);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    XXH3_64bits_update(hash.get(), block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof()) {
    throw std::invalid_argument(file.string() + ": cannot be read");
  }
  return fmt::format("{:016x}", XXH3_64bits_digest(hash.get()));
}

std::string text_hash(std::string_view text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

std::string fingerprint(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += std::to_string(part.size()) + ":" + part;
  return text_hash(all);
}

}  // namespace breakwater
