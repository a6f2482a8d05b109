#include <breakwater/record/partial_file.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <breakwater/record/data_file.h>
#include <breakwater/record/on_disk.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {

namespace fs = std::filesystem;
namespace {

constexpr const char* kMark = ".partial-";

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
  if (!is_on_disk(path_)) fail(std::strerror(errno));
}

void PartialFile::commit() {
  sync();
  std::error_code error;
  fs::rename(path_, followed(file_), error);
  if (error) fail(error.message());
}

namespace {

void write(const PartialFile& partial, const std::string& bytes) {
  try {
    write_text_file(partial.path().string(), bytes);
  } catch (const OutputError& error) {
    // The user knows only the final name.
    const std::string what = error.what();
    throw OutputError(partial.file().string() + what.substr(partial.path().string().size()));
  }
}

}  // namespace

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

}  // namespace breakwater
