#include <breakwater/experiment/provenance.h>

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <string_view>

#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace {

std::size_t aligned(std::size_t size, std::size_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}

// The build id among the notes of a segment; empty if there is none.
std::string_view build_id_in(const char* notes, std::size_t size, std::size_t alignment) {
  while (size >= sizeof(ElfW(Nhdr))) {
    const auto& note = *reinterpret_cast<const ElfW(Nhdr)*>(notes);
    const std::size_t begin = aligned(sizeof note + note.n_namesz, alignment);
    const std::size_t end = begin + aligned(note.n_descsz, alignment);
    if (note.n_type == NT_GNU_BUILD_ID && end <= size) return {notes + begin, note.n_descsz};
    if (end > size) break;
    notes += end;
    size -= end;
  }
  return {};
}

// The build id that the linker wrote into the program or module with this code, as it is loaded.
std::string build_id() {
  std::string id;
  const auto visit = [](dl_phdr_info* object, std::size_t, void* found) {
    const auto here = reinterpret_cast<ElfW(Addr)>(&build_id_in) - object->dlpi_addr;
    const ElfW(Phdr)* const end = object->dlpi_phdr + object->dlpi_phnum;
    const bool is_ours = std::any_of(object->dlpi_phdr, end, [&](const ElfW(Phdr) & segment) {
      return segment.p_type == PT_LOAD && here - segment.p_vaddr < segment.p_memsz;
    });
    if (!is_ours) return 0;
    for (const ElfW(Phdr)* segment = object->dlpi_phdr; segment != end; ++segment) {
      if (segment->p_type != PT_NOTE) continue;
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader gives numbers
      const auto* notes = reinterpret_cast<const char*>(object->dlpi_addr + segment->p_vaddr);
      *static_cast<std::string*>(found) += build_id_in(notes, segment->p_memsz, segment->p_align);
    }
    return 1;
  };
  dl_iterate_phdr(visit, &id);
  return id;
}

}  // namespace

std::vector<std::filesystem::path> model_paths(const std::vector<std::string>& files) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& file : files) {
    for (auto& path : mjcf_files(file)) paths.push_back(std::move(path));
  }
  return paths;
}

ModelHashes model_hashes(const std::vector<std::string>& files) {
  ModelHashes hashes;
  for (const auto& path : model_paths(files)) hashes[portable_path(path)] = file_hash(path);
  return hashes;
}

std::string point_key(const std::string& config_text, const ModelHashes& models) {
  std::vector<std::string> parts(1, config_text);
  for (const auto& [file, hash] : models) parts.insert(parts.end(), {file, hash});
  return fingerprint(parts);
}

const std::string& program_hash() {
  static const std::string hash = [] {
    const std::string id = build_id();
    return id.empty() ? file_hash(program_file()) : text_hash(id);
  }();
  return hash;
}

}  // namespace breakwater
