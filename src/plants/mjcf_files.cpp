#include <breakwater/plants/mjcf_tree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <breakwater/plants/xml_file.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// Reads the files of a model as the engine does (mjCReader, mjXReader in MuJoCo 2.2). Includes and
// folders are relative to the folder of the main file, also in an included file.
class MjcfReader {
 public:
  // Adds the files that exist to `files`, each once.
  MjcfReader(fs::path mjcf, std::vector<fs::path>& files) : mjcf_(std::move(mjcf)), files_(files) {}

  // Throws as read_xml() does, and if a file is missing.
  void read() {
    std::vector<MjcfElement> top;
    add(mjcf_);
    read(read_xml(mjcf_.string()), top);
    if (!top.empty()) root = std::move(top.front());  // an <include> may have none
    if (root.name == "mujoco") find_assets(root);
  }

  MjcfElement root;              // with all included elements
  std::vector<fs::path> models;  // files for <attach>

 private:
  void add(const fs::path& file) {
    const fs::path path = file.lexically_normal();
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return;
    open_input(path);
    if (std::find(files_.begin(), files_.end(), path) == files_.end()) files_.push_back(path);
  }

  void read(MjcfElement element, std::vector<MjcfElement>& out) {
    const bool is_include = element.name == "include";
    if (is_include) {
      const fs::path path = (folder() / element.text("file")).lexically_normal();
      if (element.text("file").empty()) element.fail("needs a file");
      if (!included_.insert(path).second) element.fail("includes a file a second time");
      add(path);
      element = read_xml(path.string());
    }
    std::vector<MjcfElement> children = std::exchange(element.children, {});
    for (MjcfElement& child : children) read(std::move(child), is_include ? out : element.children);
    if (!is_include) out.push_back(std::move(element));
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
  std::set<fs::path> included_ = {mjcf_.lexically_normal()};
};

// A model and those that it attaches, each once.
std::vector<MjcfElement> read_models(const fs::path& mjcf, std::vector<fs::path>& files) {
  std::vector<fs::path> models = {mjcf.lexically_normal()};
  std::vector<MjcfElement> roots;
  for (std::size_t i = 0; i < models.size(); ++i) {
    MjcfReader reader(models[i], files);
    reader.read();
    roots.push_back(std::move(reader.root));
    for (const fs::path& model : reader.models) {
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    }
  }
  return roots;
}

// Attributes with names, which may be "nan".
bool holds_a_name(std::string_view attribute) {
  static const std::set<std::string_view> names = {
      "name",   "class",    "childclass", "model",   "file",    "prefix", "joint",
      "body",   "site",     "geom",       "tendon",  "target",  "mesh",   "texture",
      "hfield", "material", "objname",    "refname", "actuator"};
  return names.contains(attribute);
}

// Attributes that must not be negative in any element. The engine reads a negative mass as 0 and
// accepts the others.
bool must_not_be_negative(std::string_view attribute) {
  static const std::set<std::string_view> names = {
      "mass",         "diaginertia", "density",    "viscosity", "armature",   "damping",
      "frictionloss", "friction",    "fovy",       "offwidth",  "offheight",  "znear",
      "zfar",         "extent",      "shadowclip", "group",     "numslices",  "shadowsize",
      "numstacks",    "rgba",        "rgb1",       "rgb2",      "markrgb",    "ambient",
      "diffuse",      "specular",    "shininess",  "emission",  "reflectance"};
  return names.contains(attribute);
}

// The engine allocates memory for the numbers of <size>, and for <numeric>, without a limit. It
// needs user data once for each element.
double largest(std::string_view kind, std::string_view attribute) {
  constexpr double kLargestSize = 1e7;
  constexpr double kMostUserData = 1e3;
  if (kind == "numeric" && attribute == "size") return kLargestSize;
  if (kind != "size") return std::numeric_limits<double>::infinity();
  return attribute.starts_with("nuser_") ? kMostUserData : kLargestSize;
}

double number_of(const MjcfElement& element, std::string_view attribute) {
  const auto numbers = read_numbers(element.text(attribute));
  return numbers && !numbers->empty() ? std::max(numbers->front(), 0.0) : 0.0;
}

// The memory of a grid [bytes]: heights as floats, or pixels. A texture is a cube of six squares
// unless it says otherwise.
double bytes_of_grid(const MjcfElement& element) {
  if (element.name == "hfield")
    return 4.0 * number_of(element, "nrow") * number_of(element, "ncol");
  if (element.name != "texture") return 0.0;
  const double width = number_of(element, "width");
  const bool is_flat = element.text("type") == "2d";
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
  return "here height fields and textures take " +
         std::to_string(std::llround(std::min(bytes, 1e18) / 1e6)) + " MB: must be at most " +
         std::to_string(std::llround(kMostBytes / 1e6)) + " MB";
}

void check_numbers(const MjcfElement& element) {
  for (const auto& [attribute, value] : element.attributes) {
    if (holds_a_name(attribute)) continue;
    for (const std::string& word : words_of(value)) {
      const auto number = read_numbers(word);
      if (!number) continue;
      std::string complaint;
      if (!is_sensible(number->front())) {
        complaint = "must be finite and not beyond 1e30";
      } else if (number->front() < 0.0 && must_not_be_negative(attribute)) {
        complaint = "must not be negative";
      } else if (number->front() < -1.0 && element.name == "size") {
        complaint = "must be at least -1";  // which the engine takes as "not given"
      } else if (number->front() > largest(element.name, attribute)) {
        complaint = "must be at most " +
                    std::to_string(static_cast<long>(largest(element.name, attribute)));
      } else {
        continue;
      }
      throw std::invalid_argument(element.place + ": <" + element.name + "> " + attribute + "=\"" +
                                  value + "\": " + complaint);
    }
  }
}

// The number of model elements of an XML element; for a <composite> the product of its counts.
double elements_of(const MjcfElement& element) {
  if (element.name != "composite") return 1.0;
  double product = 1.0;
  for (const double count : read_numbers(element.text("count")).value_or(std::vector<double>())) {
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
  const auto check = [&](const auto& same, const MjcfElement& element) -> void {
    check_numbers(element);
    elements += elements_of(element);
    if (elements > static_cast<double>(most_elements)) {
      element.fail("here the model has " + std::to_string(std::llround(std::min(elements, 1e18))) +
                   " elements: model.most_elements allows " + std::to_string(most_elements));
    }
    bytes += bytes_of_grid(element);
    if (const std::string complaint = too_large(bytes); !complaint.empty()) element.fail(complaint);
    for (const MjcfElement& child : element.children) same(same, child);
  };
  std::vector<fs::path> files;
  for (const MjcfElement& root : read_models(file, files)) check(check, root);
  bytes = 0.0;
  for (const auto& asset : files) {  // meshes and textures must be regular files too
    bytes += bytes_of_png(asset);
    if (const std::string complaint = too_large(bytes); !complaint.empty()) {
      throw std::invalid_argument(asset.string() + ": " + complaint);
    }
  }
}

}  // namespace breakwater
