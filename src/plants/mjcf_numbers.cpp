#include <breakwater/plants/mjcf_numbers.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace {

// What is named so, or names something, may be called "nan".
bool holds_a_name(const tinyxml2::XMLAttribute& attribute) {
  static const std::set<std::string_view> names = {
      "name",   "class",    "childclass", "model",   "file",    "prefix", "joint",
      "body",   "site",     "geom",       "tendon",  "target",  "mesh",   "texture",
      "hfield", "material", "objname",    "refname", "actuator"};
  return names.contains(attribute.Name());
}

// What cannot be negative, in whatever element: the engine takes a negative mass for 0, and others
// as they are.
bool must_not_be_negative(const tinyxml2::XMLAttribute& attribute) {
  static const std::set<std::string_view> names = {
      "mass",    "diaginertia", "density",    "viscosity", "armature",  "damping",  "frictionloss",
      "fovy",    "offwidth",    "offheight",  "znear",     "zfar",      "extent",   "shadowclip",
      "group",   "numslices",   "shadowsize", "numstacks", "rgba",      "rgb1",     "rgb2",
      "markrgb", "ambient",     "diffuse",    "specular",  "shininess", "emission", "reflectance"};
  return names.contains(attribute.Name());
}

std::string quoted(const tinyxml2::XMLAttribute& attribute) {
  return std::string(attribute.Name()) + "=\"" + attribute.Value() + "\"";
}

void check_element(const XmlFile& xml, const tinyxml2::XMLElement& element) {
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    if (holds_a_name(*attribute)) continue;
    std::istringstream words(attribute->Value());
    for (std::string word; words >> word;) {
      const auto number = read_numbers(word);
      if (!number) continue;
      const char* complaint = nullptr;
      if (!is_sensible(number->front())) {
        complaint = ": must be finite and not beyond 1e30";
      } else if (number->front() < 0.0 && must_not_be_negative(*attribute)) {
        complaint = ": must not be negative";
      }
      if (complaint != nullptr) {
        xml.fail(attribute->GetLineNum(),
                 std::string("<") + element.Name() + "> " + quoted(*attribute) + complaint);
      }
    }
  }
}

// `folder` is that of the model's own file, from where the engine looks for what is included.
void check_file(const std::filesystem::path& file, const std::filesystem::path& folder,
                std::set<std::filesystem::path>& seen) {
  if (!seen.insert(file.lexically_normal()).second) return;
  const XmlFile xml(file.string());
  std::vector<const tinyxml2::XMLElement*> elements = {xml.root()};
  while (!elements.empty()) {
    const tinyxml2::XMLElement* element = elements.back();
    elements.pop_back();
    check_element(xml, *element);
    const char* included = element->Attribute("file");
    if (included != nullptr && std::string_view(element->Name()) == "include") {
      check_file(folder / included, folder, seen);
    }
    for (const auto* child = element->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      elements.push_back(child);
    }
  }
}

}  // namespace

void check_mjcf_numbers(const std::string& file) {
  std::set<std::filesystem::path> seen;
  check_file(file, std::filesystem::path(file).parent_path(), seen);
}

}  // namespace breakwater
