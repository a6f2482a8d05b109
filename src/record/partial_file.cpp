#include <breakwater/record/partial_file.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include <breakwater/record/output_error.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {

namespace fs = std::filesystem;
namespace {

constexpr const char* kMark = ".partial-";

void write(const PartialFile& partial, const std::string& bytes) {
  try {
    write_text_file(partial.path().string(), bytes);
  } catch (const OutputError& error) {
    throw with_final_name(error, partial.path(), partial.file());
  }
}

}  // namespace

void remove_left(const fs::path& file) {
  const std::string begin = hidden_name(file, kMark);
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(file.has_parent_path() ? file.parent_path() : ".", ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || !is_of_dead_process(name.substr(begin.size()))) continue;
    if (!detail::is_locked(entry.path())) fs::remove(entry.path(), ignored);
  }
}

PartialFile::PartialFile(fs::path file) : file_(std::move(file)) {
  const fs::path target = followed(file_);
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    fail("it is no file");
  }
  remove_left(target);
  path_ = target.parent_path() / (hidden_name(target, kMark) + unique_name());
  try {
    lock_ = std::make_unique<detail::DataFile>(path_, O_WRONLY | O_CREAT | O_EXCL);
    lock_->lock();
  } catch (const OutputError&) {
    fail(std::strerror(errno));
  }
}

PartialFile::~PartialFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void PartialFile::fail(const std::string& reason) const {
  throw OutputError(file_.string() + ": cannot be written (" + reason + ")");
}

void PartialFile::sync() const {
  try {
    lock_->sync();
  } catch (const OutputError&) {
    fail(std::strerror(errno));
  }
}

void PartialFile::commit() {
  sync();
  std::error_code error;
  fs::rename(path_, followed(file_), error);
  if (error) fail(error.message());
}

OutputError with_final_name(const OutputError& error, const fs::path& partial,
                            const fs::path& file) {
  const std::string what = error.what(), hidden = partial.string();
  if (!what.starts_with(hidden)) return error;
  return OutputError(file.string() + what.substr(hidden.size()));
}

bool create_file(const fs::path& file, const std::string& bytes) {
  PartialFile partial(file);
  write(partial, bytes);
  partial.sync();
  // link() does not replace a file, unlike rename().
  if (link(partial.path().c_str(), file.c_str()) == 0) return true;
  if (errno == EEXIST) return false;
  partial.commit();  // the file system has no hard links
  return true;
}

void replace_file(const fs::path& file, const std::string& bytes) {
  PartialFile partial(file);
  write(partial, bytes);
  partial.commit();
}

bool is_on_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

}  // namespace breakwater

namespace breakwater::detail {

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

void DataFile::sync() const {
  if (!is_on_disk(descriptor_)) fail("written to the disk");
}

bool is_locked(const std::filesystem::path& path) {
  try {
    return !DataFile(path, O_RDONLY).lock();
  } catch (const OutputError&) {
    return false;
  }
}

}  // namespace breakwater::detail
