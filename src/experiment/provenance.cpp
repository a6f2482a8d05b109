#include <breakwater/experiment/provenance.h>

#include <elf.h>
#include <link.h>

#include <span>
#include <string_view>
#include <vector>

#include <breakwater/record/file_hash.h>
#include <breakwater/shell/paths.h>

// The linker's name of the first byte of the program or module.
// NOLINTNEXTLINE(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
extern "C" [[gnu::visibility("hidden")]] const ElfW(Ehdr) __ehdr_start;

namespace breakwater {
namespace {

// The build id of the program or module with this code, as it is loaded; empty if there is none.
std::string_view build_id() {
  constexpr std::size_t kBytes = 20;                                      // a SHA-1
  constexpr char kNote[] = {NT_GNU_BUILD_ID, 0, 0, 0, 'G', 'N', 'U', 0};  // its type and owner
  const auto* const begin = reinterpret_cast<const char*>(&__ehdr_start);
  const auto* const segments = reinterpret_cast<const ElfW(Phdr)*>(begin + __ehdr_start.e_phoff);
  for (const ElfW(Phdr) & segment : std::span(segments, __ehdr_start.e_phnum)) {
    if (segment.p_type != PT_NOTE) continue;
    const std::string_view notes(begin + segment.p_offset, segment.p_memsz);
    const std::size_t at = notes.find(std::string_view(kNote, sizeof kNote));
    if (at != std::string_view::npos) return notes.substr(at + sizeof kNote, kBytes);
  }
  return {};
}

}  // namespace

std::string point_key(const std::string& config_text, const ModelHashes& models) {
  std::vector<std::string> parts(1, config_text);
  for (const auto& [file, hash] : models) parts.insert(parts.end(), {file, hash});
  return fingerprint(parts);
}

const std::string& program_hash() {
  static const std::string hash = [] {
    const std::string_view id = build_id();
    return id.empty() ? file_hash(program_file()) : text_hash(id);
  }();
  return hash;
}

}  // namespace breakwater
