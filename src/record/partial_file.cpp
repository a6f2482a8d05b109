#include <breakwater/record/partial_file.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <breakwater/record/on_disk.h>
#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {

namespace fs = std::filesystem;
namespace {

std::string begin_of_name(const fs::path& file) {
  return "." + file.filename().string() + ".partial-";
}

}  // namespace

void remove_left(const fs::path& file) {
  const std::string begin = begin_of_name(file);
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(file.has_parent_path() ? file.parent_path() : ".", ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || name == begin + process_name()) continue;
    if (is_of_dead_process(name.substr(begin.size()))) fs::remove(entry.path(), ignored);
  }
}

PartialFile::PartialFile(fs::path file)
    : file_(std::move(file)), path_(file_.parent_path() / (begin_of_name(file_) + process_name())) {
  remove_left(file_);
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
  fs::rename(path_, file_, error);
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
