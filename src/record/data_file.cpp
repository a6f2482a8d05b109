#include <breakwater/record/data_file.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <breakwater/record/output_error.h>

namespace breakwater::detail {
namespace {

constexpr std::size_t kCopiedAtOnce = 1 << 20;

}  // namespace

DataFile::DataFile(std::filesystem::path file, int flags)
    : file_(std::move(file)), descriptor_(open(file_.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail("opened");
}

DataFile::~DataFile() {
  close(descriptor_);
}

bool DataFile::lock() const {
  return flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

void DataFile::fail(const char* what) const {
  throw OutputError(file_.string() + ": cannot be " + what + " (" + std::strerror(errno) + ")");
}

void DataFile::write(const void* data, std::size_t bytes, std::uint64_t place) {
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = pwrite(descriptor_, from, bytes, static_cast<off_t>(place));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail("written");
    from += done;
    place += static_cast<std::uint64_t>(done);
    bytes -= static_cast<std::size_t>(done);
  }
}

std::size_t DataFile::read(void* data, std::size_t bytes, std::uint64_t place) const {
  std::size_t all = 0;
  while (all < bytes) {
    const ssize_t done = pread(descriptor_, static_cast<char*>(data) + all, bytes - all,
                               static_cast<off_t>(place + all));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail("read");
    if (done == 0) break;
    all += static_cast<std::size_t>(done);
  }
  return all;
}

void DataFile::sync() const {
  if (fdatasync(descriptor_) != 0) fail("written to the disk");
}

bool is_locked(const std::filesystem::path& path) {
  try {
    return !DataFile(path, O_RDONLY).lock();
  } catch (const OutputError&) {
    return false;
  }
}

void copy(const DataFile& from, std::uint64_t from_place, DataFile& to, std::uint64_t to_place,
          std::uint64_t bytes) {
  std::vector<char> block(std::min<std::uint64_t>(bytes, kCopiedAtOnce));
  for (std::uint64_t done = 0; done < bytes; done += block.size()) {
    block.resize(std::min<std::uint64_t>(block.size(), bytes - done));
    block.resize(from.read(block.data(), block.size(), from_place + done));
    if (block.empty()) throw OutputError("the log ends early");
    to.write(block.data(), block.size(), to_place + done);
  }
}

}  // namespace breakwater::detail
