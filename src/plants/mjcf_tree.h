// MJCF as a tree of elements that can be changed; the files of a model and the check of their
// numbers.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <breakwater/plants/xml_file.h>

namespace breakwater {

using MjcfElement = XmlElement;

/// A change by a conversion, once for all its places.
struct MjcfChange {
  /// `dropped`: the model has lost something. `approximated`: something is only nearly the same.
  enum class Loss { none, approximated, dropped };
  Loss loss;
  std::string what;
  std::string place;  ///< FILE:LINE of the first one
  int count = 1;
};

struct MjcfChanges : std::vector<MjcfChange> {
  void add(MjcfChange::Loss loss, const std::string& what, const std::string& place);
};

/// The numbers of a text. Throws as MjcfElement::fail() if it has others than `least` to `most`.
std::vector<double> mjcf_numbers(const MjcfElement& element, const std::string& text,
                                 std::size_t least, std::size_t most);

/// The values that default classes give.
class MjcfClasses {
 public:
  MjcfClasses() = default;
  explicit MjcfClasses(const MjcfElement& root);

  /// The elements of a class that apply to a kind of element, those of the outermost class first.
  /// All kinds of actuators share their defaults.
  std::vector<const MjcfElement*> defaults(const std::string& kind, const std::string& name) const;
  /// The value of an attribute: the element's own, or that of its class; null if there is none.
  /// `inherited` is the class of an element that names none.
  const std::string* find(const MjcfElement& element, std::string_view attribute,
                          const std::string& inherited = "") const;

 private:
  void add(const MjcfElement& section, std::vector<MjcfElement> above);
  std::map<std::string, std::vector<MjcfElement>> classes_;
};

/// Calls visit(section) for each section of this name.
template <typename Root, typename Visit>
void for_each_section(Root& root, std::string_view name, Visit&& visit) {
  for (auto& section : root.children) {
    if (section.name == name) visit(section);
  }
}

/// Calls visit(element, parent, class) for what a section contains, also in its bodies or classes.
/// The class is the one that the element inherits, or that a <default> gives it to.
template <typename Visit>
void for_each_below(MjcfElement& parent, const std::string& inherited, Visit&& visit) {
  for (MjcfElement& child : parent.children) {
    visit(child, parent, inherited);
    if (child.name == "body") for_each_below(child, child.text("childclass", inherited), visit);
    if (child.name == "default") for_each_below(child, child.text("class"), visit);
  }
}

/// The same for all sections of a model.
template <typename Visit>
void for_each_element(MjcfElement& root, Visit&& visit) {
  for (MjcfElement& section : root.children) {
    for_each_below(section, section.name == "default" ? section.text("class", "main") : "", visit);
  }
}

/// A setting of the file: an attribute of its last <compiler> that has it.
std::string mjcf_compiler(const MjcfElement& root, std::string_view attribute,
                          const std::string& otherwise);

/// A file with its <include>s. The names of all files of assets are absolute. Throws
/// std::invalid_argument `FILE[:LINE]: reason`, also if a file is missing.
MjcfElement read_mjcf(const std::filesystem::path& mjcf);

/// The same in the form of MuJoCo 2.2, as far as the places of elements go. <attach>ed models,
/// poses of <frame> and copies of <replicate> are written out. Throws as read_mjcf(), and if there
/// are more than `most_elements` then.
MjcfElement flat_mjcf(const std::filesystem::path& file, std::uint64_t most_elements,
                      MjcfChanges& changes);

/// The text of an MJCF file.
std::string mjcf_text(const MjcfElement& root);

/// Position and rotation of an element in its body.
struct MjcfPose {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
};
/// `first` and then, in its frame, `second`.
MjcfPose operator*(const MjcfPose& first, const MjcfPose& second);
MjcfPose inverse(const MjcfPose& pose);
MjcfPose mjcf_pose(const MjcfElement& root, const MjcfClasses& classes, const MjcfElement& element,
                   const std::string& inherited);
/// Whether angles of the file are in degrees.
bool has_degrees(const MjcfElement& root);

/// An MJCF file, its includes, the models that it attaches, and the meshes, height fields, skins
/// and textures of all of them. Each existing file occurs once, the main file first. A file that
/// cannot be read whole gives those before the error, which Model::load() reports.
std::vector<std::filesystem::path> mjcf_files(const std::filesystem::path& mjcf);

/// Throws std::invalid_argument `FILE[:LINE]: reason` if an MJCF file or one of its includes cannot
/// be read, is not XML or has a wrong number. More than `most_elements` elements are refused too,
/// with those of a <composite>. A number must be finite and within ±1e30. Masses, colours and sizes
/// in pixels must not be negative, and a size of <size> must fit into memory. The engine accepts
/// NaN, 1e300 and a negative mass without a warning.
void check_mjcf(const std::string& file, std::uint64_t most_elements);

}  // namespace breakwater
