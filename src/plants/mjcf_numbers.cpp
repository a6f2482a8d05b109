#include <breakwater/plants/mjcf_numbers.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <breakwater/plants/mjcf_files.h>
#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace {

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
      "mass",    "diaginertia", "density",    "viscosity", "armature",  "damping",  "frictionloss",
      "fovy",    "offwidth",    "offheight",  "znear",     "zfar",      "extent",   "shadowclip",
      "group",   "numslices",   "shadowsize", "numstacks", "rgba",      "rgb1",     "rgb2",
      "markrgb", "ambient",     "diffuse",    "specular",  "shininess", "emission", "reflectance"};
  return names.contains(attribute.Name());
}

// The engine allocates memory for the numbers of <size> without a limit. It needs user data once
// for each element.
double largest(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute& attribute) {
  constexpr double kLargestSize = 1e7;
  constexpr double kMostUserData = 1e3;
  if (std::string_view(element.Name()) != "size") return std::numeric_limits<double>::infinity();
  return std::string_view(attribute.Name()).starts_with("nuser_") ? kMostUserData : kLargestSize;
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
      std::string complaint;
      if (!is_sensible(number->front())) {
        complaint = ": must be finite and not beyond 1e30";
      } else if (number->front() < 0.0 && must_not_be_negative(*attribute)) {
        complaint = ": must not be negative";
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

class MjcfCheck {
 public:
  MjcfCheck(const std::filesystem::path& file, std::uint64_t most_elements)
      : folder_(file.parent_path()), most_elements_(most_elements) {
    check(file);
  }

 private:
  void check(const std::filesystem::path& file) {
    if (!visited_.insert(file.lexically_normal()).second) return;
    const XmlFile xml(file.string());
    std::vector<const tinyxml2::XMLElement*> elements = {xml.root()};
    while (!elements.empty()) {
      const tinyxml2::XMLElement* element = elements.back();
      elements.pop_back();
      check_element(xml, *element);
      count(xml, *element);
      const char* included = element->Attribute("file");
      if (included != nullptr && std::string_view(element->Name()) == "include") {
        check(folder_ / included);
      }
      for (const auto* child = element->FirstChildElement(); child != nullptr;
           child = child->NextSiblingElement()) {
        elements.push_back(child);
      }
    }
  }

  void count(const XmlFile& xml, const tinyxml2::XMLElement& element) {
    elements_ += elements_of(element);
    if (elements_ <= static_cast<double>(most_elements_)) return;
    xml.fail(element.GetLineNum(), std::string("<") + element.Name() + ">: here the model has " +
                                       std::to_string(std::llround(std::min(elements_, 1e18))) +
                                       " elements: model.most_elements allows " +
                                       std::to_string(most_elements_));
  }

  std::filesystem::path folder_;  // the folder for includes
  std::uint64_t most_elements_;
  double elements_ = 0.0;
  std::set<std::filesystem::path> visited_;
};

}  // namespace

void check_mjcf(const std::string& file, std::uint64_t most_elements) {
  MjcfCheck(file, most_elements);
  mjcf_files(file);  // meshes and textures must be regular files too
}

}  // namespace breakwater
