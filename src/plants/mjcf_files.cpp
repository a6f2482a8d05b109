#include <breakwater/plants/mjcf_tree.h>

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using tinyxml2::XMLElement;

// Reads the files of a model as the engine does (mjCReader, mjXReader in MuJoCo 2.2). Includes and
// folders are relative to the folder of the main file, also in an included file.
class MjcfReader {
 public:
  using Visit = std::function<void(const XmlFile& xml, const XMLElement& element)>;

  // Adds the files that exist to `files`, each once.
  MjcfReader(fs::path mjcf, std::vector<fs::path>& files, Visit visit = {})
      : mjcf_(std::move(mjcf)), files_(files), visit_(std::move(visit)) {}

  // Calls visit(xml, element) for each element, if it is there. Throws as XmlFile does, and if a
  // file is missing.
  void read() {
    std::vector<MjcfElement> top;
    add(mjcf_);
    const XmlFile xml(mjcf_.string());
    read(xml, *xml.root(), mjcf_, top);
    if (!top.empty()) root = std::move(top.front());  // an <include> may have none
    if (root.name == "mujoco") find_assets(root);
  }

  MjcfElement root;              // with all included elements
  std::vector<fs::path> models;  // files for <attach>

 private:
  void add(const fs::path& file) {
    const fs::path path = file.lexically_normal();
    std::error_code ignored;
    check_ends(path);
    if (std::find(files_.begin(), files_.end(), path) != files_.end()) return;
    if (fs::is_regular_file(path, ignored)) files_.push_back(path);
  }

  // The recursion is safe, because tinyxml2 refuses deeply nested files.
  void read(const XmlFile& xml, const XMLElement& from, const fs::path& file,
            std::vector<MjcfElement>& out) {
    if (visit_) visit_(xml, from);
    MjcfElement element{
        from.Name(), file.string() + ":" + std::to_string(from.GetLineNum()), {}, {}};
    for (const auto* one = from.FirstAttribute(); one != nullptr; one = one->Next()) {
      element.attributes.emplace_back(one->Name(), one->Value());
    }
    if (element.name == "include") {
      const fs::path path = (folder() / element.text("file")).lexically_normal();
      if (element.text("file").empty()) element.fail("needs a file");
      if (!included_.insert(path).second) element.fail("includes a file a second time");
      add(path);
      const XmlFile included(path.string());
      if (visit_) visit_(included, *included.root());
      read_children(included, *included.root(), path, out);
      return;
    }
    read_children(xml, from, file, element.children);
    out.push_back(std::move(element));
  }

  void read_children(const XmlFile& xml, const XMLElement& from, const fs::path& file,
                     std::vector<MjcfElement>& out) {
    for (const auto* child = from.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      read(xml, *child, file, out);
    }
  }

  // Adds the files of the assets, and makes their names absolute.
  void find_assets(MjcfElement& parent) {
    for (MjcfElement& asset : parent.children) {
      find_assets(asset);
      static const std::map<std::string_view, const char*> folders = {{"mesh", "meshdir"},
                                                                      {"hfield", "meshdir"},
                                                                      {"skin", "meshdir"},
                                                                      {"texture", "texturedir"},
                                                                      {"model", ""}};
      const auto kind = folders.find(asset.name);
      if (kind == folders.end()) continue;
      const bool is_model = asset.name == "model";  // its folder is that of the main file
      const std::string own =
          is_model ? "" : mjcf_compiler(root, kind->second, mjcf_compiler(root, "assetdir", ""));
      for (auto& [attribute, value] : asset.attributes) {
        if (!attribute.starts_with("file")) continue;
        fs::path name = value;
        if (mjcf_compiler(root, "strippath", "false") == "true") name = name.filename();
        const fs::path path = folder() / own / name;
        add(path);
        value = fs::absolute(path).lexically_normal().string();
        std::error_code ignored;
        if (!fs::is_regular_file(path, ignored)) asset.fail("there is no file " + value);
        if (is_model) models.push_back(path.lexically_normal());
      }
    }
  }

  fs::path folder() const { return mjcf_.parent_path(); }

  fs::path mjcf_;
  std::vector<fs::path>& files_;
  Visit visit_;
  std::set<fs::path> included_ = {mjcf_.lexically_normal()};
};

// Reads a model and those that it attaches, each once.
void read_models(const fs::path& mjcf, std::vector<fs::path>& files,
                 const MjcfReader::Visit& visit = {}) {
  std::vector<fs::path> models = {mjcf.lexically_normal()};
  for (std::size_t i = 0; i < models.size(); ++i) {
    MjcfReader reader(models[i], files, visit);
    reader.read();
    for (const fs::path& model : reader.models) {
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    }
  }
}

// Attributes with names, which may be "nan".
bool holds_a_name(const tinyxml2::XMLAttribute& attribute) {
  static const std::set<std::string_view> names = {
      "name",   "class",    "childclass", "model",   "file",    "prefix", "joint",
      "body",   "site",     "geom",       "tendon",  "target",  "mesh",   "texture",
      "hfield", "material", "objname",    "refname", "actuator"};
  return names.contains(attribute.Name());
}

// Attributes that must not be negative in any element. The engine reads a negative mass as 0 and
// accepts the others.
bool must_not_be_negative(const tinyxml2::XMLAttribute& attribute) {
  static const std::set<std::string_view> names = {
      "mass",         "diaginertia", "density",    "viscosity", "armature",   "damping",
      "frictionloss", "friction",    "fovy",       "offwidth",  "offheight",  "znear",
      "zfar",         "extent",      "shadowclip", "group",     "numslices",  "shadowsize",
      "numstacks",    "rgba",        "rgb1",       "rgb2",      "markrgb",    "ambient",
      "diffuse",      "specular",    "shininess",  "emission",  "reflectance"};
  return names.contains(attribute.Name());
}

// The engine allocates memory for the numbers of <size>, and for <numeric>, without a limit. It
// needs user data once for each element.
double largest(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute& attribute) {
  constexpr double kLargestSize = 1e7;
  constexpr double kMostUserData = 1e3;
  const std::string_view kind = element.Name();
  const std::string_view name = attribute.Name();
  if (kind == "numeric" && name == "size") return kLargestSize;
  if (kind != "size") return std::numeric_limits<double>::infinity();
  return name.starts_with("nuser_") ? kMostUserData : kLargestSize;
}

double number_of(const tinyxml2::XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  const auto numbers = text != nullptr ? read_numbers(text) : std::nullopt;
  return numbers && !numbers->empty() ? std::max(numbers->front(), 0.0) : 0.0;
}

// The memory of a grid [bytes]: heights as floats, or pixels. A texture is a cube of six squares
// unless it says otherwise.
double bytes_of_grid(const tinyxml2::XMLElement& element) {
  const std::string_view kind = element.Name();
  if (kind == "hfield") return 4.0 * number_of(element, "nrow") * number_of(element, "ncol");
  if (kind != "texture") return 0.0;
  const char* type = element.Attribute("type");
  const double width = number_of(element, "width");
  const bool is_flat = type != nullptr && std::string_view(type) == "2d";
  return 3.0 * width * (is_flat ? number_of(element, "height") : 6.0 * width);
}

// The memory of a PNG's pixels [bytes], by its head; 0 for another file.
double bytes_of_png(const std::filesystem::path& file) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  std::array<unsigned char, 24> head = {};
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(head.data()), head.size());
  if (!stream ||
      !std::equal(kSignature.begin(), kSignature.end(), head.begin(),
                  [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; })) {
    return 0.0;
  }
  const auto size = [&](std::size_t at) {
    double value = 0.0;
    for (std::size_t i = at; i < at + 4; ++i) value = 256.0 * value + head[i];
    return value;
  };
  return 3.0 * size(16) * size(20);
}

// The complaint about the memory of grids; empty if it is small enough.
std::string too_large(double bytes) {
  constexpr double kMostBytes = 250e6;
  if (bytes <= kMostBytes) return "";
  return ": here height fields and textures take " +
         std::to_string(std::llround(std::min(bytes, 1e18) / 1e6)) + " MB: must be at most " +
         std::to_string(std::llround(kMostBytes / 1e6)) + " MB";
}

std::string quoted(const tinyxml2::XMLAttribute& attribute) {
  return std::string(attribute.Name()) + "=\"" + attribute.Value() + "\"";
}

void check_element(const XmlFile& xml, const tinyxml2::XMLElement& element) {
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    if (holds_a_name(*attribute)) continue;
    for (const std::string& word : words_of(attribute->Value())) {
      const auto number = read_numbers(word);
      if (!number) continue;
      std::string complaint;
      if (!is_sensible(number->front())) {
        complaint = ": must be finite and not beyond 1e30";
      } else if (number->front() < 0.0 && must_not_be_negative(*attribute)) {
        complaint = ": must not be negative";
      } else if (number->front() < -1.0 && std::string_view(element.Name()) == "size") {
        complaint = ": must be at least -1";  // which the engine takes as "not given"
      } else if (number->front() > largest(element, *attribute)) {
        const auto most = static_cast<long>(largest(element, *attribute));
        complaint = ": must be at most " + std::to_string(most);
      }
      if (!complaint.empty()) {
        xml.fail(attribute->GetLineNum(),
                 std::string("<") + element.Name() + "> " + quoted(*attribute) + complaint);
      }
    }
  }
}

// The number of model elements of an XML element; for a <composite> the product of its counts.
double elements_of(const tinyxml2::XMLElement& element) {
  const char* counts = element.Attribute("count");
  if (counts == nullptr || std::string_view(element.Name()) != "composite") return 1.0;
  double product = 1.0;
  for (const double count : read_numbers(counts).value_or(std::vector<double>())) {
    product *= std::max(count, 1.0);
  }
  return product;
}

}  // namespace

MjcfElement read_mjcf(const fs::path& mjcf) {
  std::vector<fs::path> files;
  MjcfReader reader(mjcf, files);
  reader.read();
  return std::move(reader.root);
}

std::vector<fs::path> mjcf_files(const fs::path& mjcf) {
  std::vector<fs::path> files;
  try {
    read_models(mjcf, files);
  } catch (const std::invalid_argument&) {  // Model::load() reports it
  }
  return files;
}

void check_mjcf(const std::string& file, std::uint64_t most_elements) {
  double elements = 0.0, bytes = 0.0;  // bytes of all grids
  std::vector<fs::path> files;
  read_models(file, files, [&](const XmlFile& xml, const XMLElement& element) {
    const auto refuse = [&](const std::string& complaint) {
      xml.fail(element.GetLineNum(), std::string("<") + element.Name() + ">" + complaint);
    };
    check_element(xml, element);
    elements += elements_of(element);
    if (elements > static_cast<double>(most_elements)) {
      refuse(": here the model has " + std::to_string(std::llround(std::min(elements, 1e18))) +
             " elements: model.most_elements allows " + std::to_string(most_elements));
    }
    bytes += bytes_of_grid(element);
    if (const std::string complaint = too_large(bytes); !complaint.empty()) refuse(complaint);
  });
  bytes = 0.0;
  for (const auto& asset : files) {  // meshes and textures must be regular files too
    bytes += bytes_of_png(asset);
    if (const std::string complaint = too_large(bytes); !complaint.empty()) {
      throw std::invalid_argument(asset.string() + complaint);
    }
  }
}

}  // namespace breakwater
