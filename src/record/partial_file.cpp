#include <breakwater/record/partial_file.h>

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

void replace_file(const std::filesystem::path& file, const std::string& bytes) {
  PartialFile partial(file);
  try {
    write_text_file(partial.path().string(), bytes);
  } catch (const OutputError& error) {
    // It is the file's own name that means something to a user.
    const std::string what = error.what();
    throw OutputError(file.string() + what.substr(partial.path().string().size()));
  }
  partial.commit();
}

}  // namespace breakwater
