#include <breakwater/record/partial_file.h>

#include <unistd.h>

#include <cerrno>

#include <breakwater/record/process_name.h>
#include <breakwater/record/text_outputs.h>

namespace breakwater {

PartialFile::PartialFile(std::filesystem::path file)
    : file_(std::move(file)),
      path_(file_.parent_path() /
            ("." + file_.filename().string() + ".partial-" + process_name())) {}

PartialFile::~PartialFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void PartialFile::commit() {
  std::error_code error;
  std::filesystem::rename(path_, file_, error);
  if (error) {
    throw OutputError(file_.string() + ": cannot be written (" + error.message() + ")");
  }
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

bool create_file(const std::filesystem::path& file, const std::string& bytes) {
  PartialFile partial(file);
  write(partial, bytes);
  // link() does not replace a file, unlike rename().
  if (link(partial.path().c_str(), file.c_str()) == 0) return true;
  if (errno == EEXIST) return false;
  partial.commit();  // the file system has no hard links
  return true;
}

void replace_file(const std::filesystem::path& file, const std::string& bytes) {
  PartialFile partial(file);
  write(partial, bytes);
  partial.commit();
}

}  // namespace breakwater
