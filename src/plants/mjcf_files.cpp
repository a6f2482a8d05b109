#include <breakwater/plants/mjcf_files.h>

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <string>

#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using tinyxml2::XMLElement;

// Finds files as the engine's reader does (mjCReader, mjXReader in MuJoCo 2.2). Includes and
// folders are relative to the folder of the main file, also in an included file.
class MjcfFiles {
 public:
  explicit MjcfFiles(const fs::path& mjcf) : folder_(mjcf.parent_path()) {
    read(mjcf);
    for (const Asset& asset : assets_) {
      const fs::path name(strips_ ? asset.name.filename() : asset.name);
      add(folder_ / (asset.is_texture ? texture_folder_ : mesh_folder_) / name);
    }
  }

  std::vector<fs::path> files;

 private:
  struct Asset {
    fs::path name;
    bool is_texture;
  };

  bool add(const fs::path& file) {
    const fs::path path = file.lexically_normal();
    std::error_code ignored;
    check_ends(path);
    if (!fs::is_regular_file(path, ignored)) return false;
    if (std::find(files.begin(), files.end(), path) != files.end()) return false;
    files.push_back(path);
    return true;
  }

  void read(const fs::path& file) {
    if (!add(file)) return;
    tinyxml2::XMLDocument xml;
    if (xml.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return;
    visit(xml.RootElement());
  }

  // The recursion is safe, because tinyxml2 refuses deeply nested files.
  void visit(const XMLElement* element) {
    for (; element != nullptr; element = element->NextSiblingElement()) {
      const std::string kind = element->Name();
      if (kind == "compiler") {
        if (const char* folder = element->Attribute("meshdir")) mesh_folder_ = folder;
        if (const char* folder = element->Attribute("texturedir")) texture_folder_ = folder;
        element->QueryBoolAttribute("strippath", &strips_);
      } else if (kind == "include") {
        if (const char* name = element->Attribute("file")) read(folder_ / name);
      } else if (kind == "mesh" || kind == "hfield" || kind == "skin" || kind == "texture") {
        constexpr std::array<const char*, 7> kFiles = {
            "file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"};
        for (const char* key : kFiles) {
          const char* name = element->Attribute(key);
          if (name != nullptr) assets_.push_back({name, kind == "texture"});
        }
      }
      visit(element->FirstChildElement());
    }
  }

  fs::path folder_;
  fs::path mesh_folder_;
  fs::path texture_folder_;
  bool strips_ = false;
  std::vector<Asset> assets_;
};

}  // namespace

std::vector<fs::path> mjcf_files(const fs::path& mjcf) {
  return MjcfFiles(mjcf).files;
}

}  // namespace breakwater
