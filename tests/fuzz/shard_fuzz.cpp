// The lines of a shard, each with a right checksum, and the bytes as they are. A result that is
// written is read as the same.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/process_name.h>
#include <breakwater/study/shards.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

constexpr std::size_t kPoints = 10;

bool are_same(const PointResult& a, const PointResult& b) {
  const auto is_same_metric = [](const auto& one, const auto& other) {
    const bool are_nan = std::isnan(one.second) && std::isnan(other.second);
    return one.first == other.first && (one.second == other.second || are_nan);
  };
  return a.key == b.key && a.status == b.status && a.reason == b.reason &&
         a.state_hash == b.state_hash &&
         std::equal(a.metrics.begin(), a.metrics.end(), b.metrics.begin(), b.metrics.end(),
                    is_same_metric);
}

PointResult written(const PointResult& result) {
  static const fuzz::Folder folder;
  {
    Shard shard(folder.path());
    shard.begin(result.number, result.key);
    shard.add(result);
    shard.finish();
  }
  PointResult read = ShardIndex(folder.path(), kPoints).read(result.number);
  std::filesystem::remove(folder.path() / (process_name() + "-0.shard"));
  return read;
}

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace breakwater;
  const fuzz::Folder& folder = fuzz::folder();
  fuzz::count("shard");
  std::string_view text = fuzz::text_of(data, size);
  std::string bytes = std::string(text) + "\n";
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    bytes += text_hash(line) + "\t" + std::string(line) + "\n";
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  folder.write(process_name() + "-0.shard", bytes);
  try {
    const ShardIndex index(folder.path(), kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
      if (!index.has(i)) continue;
      // The first time, control characters become blanks.
      const PointResult result = written(index.read(i));
      fuzz::require(are_same(written(result), result), "a result is read as it was written");
    }
    index.check_models();
    index.find("0");
    results_by_key(folder.path());
    results_of_process(folder.path(), getpid(), {});
  } catch (const std::invalid_argument&) {
    // refused in one line
  }
  return 0;
}
