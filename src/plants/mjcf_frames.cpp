// Attached models, frames and replicates of MJCF, written out.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>
#include <set>

#include <breakwater/math/functions.h>
#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/plants/xml_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Loss = MjcfChange::Loss;
using Names = std::set<std::pair<std::string, std::string>>;  // kind and name

constexpr std::array kRotations = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};
constexpr std::array kSectionsThatRefer = {"tendon", "equality", "contact", "actuator", "sensor"};

Quaterniond turn(double angle_rad, const Vector3d& axis) {
  const auto [sine, cosine] = math::sincos(0.5 * angle_rad);
  Quaterniond rotation;
  rotation.w() = cosine;
  rotation.vec() = sine * axis.normalized();
  return rotation;
}

Quaterniond euler_rotation(const MjcfElement& root, const std::vector<double>& angles) {
  const std::string sequence = mjcf_compiler(root, "eulerseq", "xyz");
  const double unit = has_degrees(root) ? std::numbers::pi / 180.0 : 1.0;
  Quaterniond rotation = Quaterniond::Identity();
  for (std::size_t i = 0; i < 3 && i < sequence.size(); ++i) {
    const int axis = std::tolower(static_cast<unsigned char>(sequence[i])) - 'x';
    if (axis < 0 || axis > 2) break;  // the engine refuses it
    const Quaterniond one = turn(unit * angles[i], Vector3d::Unit(axis));
    // Small letters turn about the axes that have turned.
    rotation = std::islower(static_cast<unsigned char>(sequence[i])) != 0 ? rotation * one
                                                                          : one * rotation;
  }
  return rotation;
}

Quaterniond rotation_of(const MjcfElement& root, const MjcfElement& element,
                        const std::string& kind, const std::string& text) {
  const std::size_t size = kind == "xyaxes" ? 6 : kind == "euler" || kind == "zaxis" ? 3 : 4;
  const std::vector<double> v = mjcf_numbers(element, text, size, size);
  if (kind == "quat") return Quaterniond(v[0], v[1], v[2], v[3]).normalized();
  if (kind == "euler") return euler_rotation(root, v);
  if (kind == "axisangle") {
    return turn(v[3] * (has_degrees(root) ? std::numbers::pi / 180.0 : 1.0), {v[0], v[1], v[2]});
  }
  if (kind == "xyaxes") {
    Eigen::Matrix3d axes;
    axes.col(0) = Vector3d(v[0], v[1], v[2]).normalized();
    const Vector3d y(v[3], v[4], v[5]);
    axes.col(1) = (y - axes.col(0).dot(y) * axes.col(0)).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return Quaterniond(axes);
  }
  const Vector3d z = Vector3d(v[0], v[1], v[2]).normalized();
  const Vector3d axis = Vector3d::UnitZ().cross(z);
  if (axis.norm() < 1e-10) return turn(z.z() > 0.0 ? 0.0 : std::numbers::pi, Vector3d::UnitX());
  return turn(math::atan2(axis.norm(), z.z()), axis);
}

// The kind of element whose name this attribute gives; empty: none.
std::string kind_referred(const MjcfElement& element, const std::string& attribute) {
  static const std::map<std::string_view, const char*> kinds = {
      {"joint", "joint"},       {"joint1", "joint"},      {"joint2", "joint"},
      {"body", "body"},         {"body1", "body"},        {"body2", "body"},
      {"target", "body"},       {"site", "site"},         {"site1", "site"},
      {"site2", "site"},        {"refsite", "site"},      {"sidesite", "site"},
      {"slidersite", "site"},   {"cranksite", "site"},    {"geom", "geom"},
      {"geom1", "geom"},        {"geom2", "geom"},        {"tendon", "tendon"},
      {"tendon1", "tendon"},    {"tendon2", "tendon"},    {"jointinparent", "joint"},
      {"actuator", "actuator"}, {"class", "class"},       {"childclass", "class"},
      {"mesh", "mesh"},         {"material", "material"}, {"texture", "texture"},
      {"hfield", "hfield"}};
  if (attribute == "objname" || attribute == "refname") {
    const std::string type = element.text(attribute == "objname" ? "objtype" : "reftype");
    return type == "xbody" ? "body" : type;
  }
  const auto found = kinds.find(attribute);
  return found == kinds.end() ? "" : found->second;
}

// `section` is that of a direct child, such as "tendon"; empty in other places.
std::string kind_named(const MjcfElement& element, const std::string& section) {
  const bool refers = std::find(kSectionsThatRefer.begin(), kSectionsThatRefer.end(), section) !=
                      kSectionsThatRefer.end();
  return refers ? section : element.name == "freejoint" ? "joint" : element.name;
}

// Calls visit(kind, value) for all names and references of an element and its children.
template <typename Element, typename Visit>
void for_each_name(Element& element, const std::string& section, Visit&& visit) {
  for (auto& [attribute, value] : element.attributes) {
    const bool is_own = attribute == "name";
    const std::string kind =
        is_own ? kind_named(element, section) : kind_referred(element, attribute);
    if (!kind.empty()) visit(kind, value, is_own);
  }
  for (auto& child : element.children) for_each_name(child, "", visit);
}

void collect_names(const std::vector<MjcfElement>& elements, Names& names) {
  for (const MjcfElement& element : elements) {
    for_each_name(element, "", [&](const std::string& kind, const std::string& value, bool own) {
      if (own) names.emplace(kind, value);
    });
  }
}

std::uint64_t size_of(const MjcfElement& element) {
  std::uint64_t size = 1;
  for (const MjcfElement& child : element.children) size += size_of(child);
  return size;
}

class FlatMjcf {
 public:
  // `above`: the files that attach this one.
  FlatMjcf(const fs::path& file, std::uint64_t most_elements, MjcfChanges& changes,
           std::set<fs::path> above = {})
      : root(read_mjcf(file)), changes_(changes), most_(most_elements), above_(std::move(above)) {
    if (root.name != "mujoco") return;
    above_.insert(file.lexically_normal());
    count(size_of(root), root);
    for_each_section(root, "compiler", [&](MjcfElement& section) {
      if (section.has("assetdir")) changes_.add(Loss::none, "compiler assetdir", section.place);
      for (const char* own : {"assetdir", "meshdir", "texturedir", "strippath"}) section.erase(own);
    });
    for_each_section(root, "worldbody", [&](MjcfElement& world) { attach_in(world); });
    for (MjcfElement& section : attached_) root.children.push_back(std::move(section));
    for_each_section(root, "asset", [](MjcfElement& assets) {
      std::erase_if(assets.children, [](const MjcfElement& e) { return e.name == "model"; });
    });
    classes_ = MjcfClasses(root);
    for_each_section(root, "worldbody", [&](MjcfElement& world) { expand(world, ""); });
  }

  MjcfElement root;

 private:
  void count(std::uint64_t more, const MjcfElement& element) {
    elements_ += more;
    if (elements_ > most_) {
      element.fail("here the model has more than the " + std::to_string(most_) +
                   " elements that model.most_elements allows");
    }
  }

  void attach_in(MjcfElement& parent) {
    std::vector<MjcfElement> out;
    for (MjcfElement& child : parent.children) {
      if (child.name == "attach") {
        attach(child, out);
      } else {
        attach_in(child);
        out.push_back(std::move(child));
      }
    }
    parent.children = std::move(out);
  }

  const MjcfElement& model_asset(const MjcfElement& attach) const {
    const std::string name = attach.text("model");
    for (const MjcfElement& section : root.children) {
      for (const MjcfElement& asset : section.children) {
        if (section.name != "asset" || asset.name != "model") continue;
        if (asset.text("name", fs::path(asset.text("file")).stem().string()) == name) return asset;
      }
    }
    attach.fail(name.empty() ? "a part of the file itself cannot be attached here"
                             : "there is no <model> \"" + name + "\"");
  }

  // Puts a body of another file, or all of its world, in place of an <attach>.
  void attach(const MjcfElement& attach, std::vector<MjcfElement>& out) {
    const fs::path file = model_asset(attach).text("file");
    if (attach.has("frame")) attach.fail("a frame of another model cannot be attached here");
    if (above_.contains(file)) attach.fail("attaches a file to itself");
    FlatMjcf other(file, most_ - elements_, changes_, above_);
    count(other.elements_, attach);
    for (const auto& [attribute, otherwise] : {std::pair("angle", "degree"),
                                               {"eulerseq", "xyz"},
                                               {"inertiafromgeom", "auto"},
                                               {"autolimits", "true"}}) {
      if (mjcf_compiler(root, attribute, otherwise) ==
          mjcf_compiler(other.root, attribute, otherwise)) {
        continue;
      }
      attach.fail(file.string() + " has another compiler " + attribute);
    }
    // The default values of the other model become a class. Values of our main class would be its
    // own too.
    MjcfElement main{"default", attach.place, {{"class", "main"}}, {}};
    for_each_section(other.root, "default", [&](MjcfElement& section) {
      main.set("class", section.text("class", main.text("class")));
      for (MjcfElement& child : section.children) main.children.push_back(std::move(child));
    });
    for_each_section(root, "default", [&](const MjcfElement& section) {
      for (const MjcfElement& own : section.children) {
        if (own.name != "default") own.fail("values of the main class do not go with <attach>");
      }
    });
    const std::string class_of_all = main.text("class");
    std::vector<MjcfElement> parts;
    for_each_section(other.root, "worldbody", [&](MjcfElement& world) {
      for_each_below(world, class_of_all,
                     [&](MjcfElement& part, MjcfElement& parent, const std::string& inherited) {
                       const bool is_wanted =
                           attach.has("body")
                               ? part.name == "body" && part.text("name") == attach.text("body")
                               : &parent == &world;
                       if (!is_wanted) return;
                       parts.push_back(part);
                       give_class(parts.back(), inherited);
                     });
    });
    if (parts.empty()) attach.fail(file.string() + " has no body \"" + attach.text("body") + "\"");
    const std::string prefix = attach.text("prefix");
    Names names;
    collect_names(parts, names);
    const auto rename = [&](MjcfElement& element, const std::string& section) {
      for_each_name(element, section,
                    [&](const std::string&, std::string& value, bool) { value = prefix + value; });
    };
    for (const char* kind : kSectionsThatRefer) {
      MjcfElement section{kind, attach.place, {}, {}};
      for_each_section(other.root, kind, [&](MjcfElement& from) {
        for (MjcfElement& one : from.children) {
          if (!refers(one, kind, names, true)) continue;
          if (one.has("name")) names.emplace(kind, one.text("name"));
          if (section.name != "sensor" && section.name != "contact") give_class(one, class_of_all);
          rename(one, kind);
          section.children.push_back(std::move(one));
        }
      });
      if (!section.children.empty()) attached_.push_back(std::move(section));
    }
    for (MjcfElement& part : parts) rename(part, "");
    rename(main, "");
    attached_.push_back({"default", attach.place, {}, {std::move(main)}});
    for_each_section(other.root, "asset", [&](MjcfElement& assets) {
      rename(assets, "");
      attached_.push_back(std::move(assets));
    });
    changes_.add(Loss::none, "attach", attach.place);
    std::move(parts.begin(), parts.end(), std::back_inserter(out));
  }

  // Whether an element has references to these names; `alone`: and to no other part of a body.
  static bool refers(const MjcfElement& element, const std::string& section, const Names& names,
                     bool alone) {
    bool one = false, other = false;
    for_each_name(element, section, [&](const std::string& kind, const std::string& name, bool) {
      const bool is_ours = names.contains({kind, name});
      one |= is_ours;
      other |= !is_ours && (kind == "body" || kind == "joint" || kind == "site" || kind == "geom" ||
                            kind == "tendon" || kind == "camera");
    });
    return one && !(alone && other);
  }

  static void give_class(MjcfElement& element, const std::string& name) {
    static const std::set<std::string_view> without = {"freejoint", "inertial", "composite",
                                                       "plugin",    "flexcomp", "exclude"};
    const char* attribute = element.name == "body" ? "childclass" : "class";
    if (name.empty() || element.has(attribute) || without.contains(element.name)) return;
    element.set(attribute, name);
  }

  void expand(MjcfElement& parent, const std::string& inherited) {
    std::vector<MjcfElement> out;
    for (MjcfElement& child : parent.children) {
      const std::string inside = child.text("childclass", inherited);
      if (child.name == "body" || child.name == "frame" || child.name == "replicate") {
        expand(child, inside);
      }
      if (child.name != "frame" && child.name != "replicate") {
        out.push_back(std::move(child));
        continue;
      }
      changes_.add(Loss::none, child.name, child.place);
      if (child.name == "frame") {
        const MjcfPose pose = mjcf_pose(root, classes_, child, inherited);
        for (MjcfElement& one : child.children) {
          place(one, pose, inside);
          if (child.has("childclass")) give_class(one, inside);
          out.push_back(std::move(one));
        }
      } else {
        replicate(child, inside, out);
      }
    }
    parent.children = std::move(out);
  }

  // The poses are those of MuJoCo 3: each copy turns about all axes by its own multiple of euler.
  // It is shifted by the offset in the frame of the copy before it.
  void replicate(const MjcfElement& element, const std::string& inside,
                 std::vector<MjcfElement>& out) {
    const double asked = mjcf_numbers(element, element.text("count"), 1, 1)[0];
    if (asked < 1.0 || asked > static_cast<double>(most_)) element.fail("count is out of range");
    const int copies = static_cast<int>(asked);
    const auto offset = mjcf_numbers(element, element.text("offset", "0 0 0"), 3, 3);
    const auto euler = mjcf_numbers(element, element.text("euler", "0 0 0"), 3, 3);
    Names names;
    collect_names(element.children, names);
    std::vector<std::string> suffixes;
    Vector3d position = Vector3d::Zero();
    for (int i = 0; i < copies; ++i) {
      const std::string digits = std::to_string(i);
      suffixes.push_back(element.text("sep") +
                         std::string(std::to_string(copies).size() - digits.size(), '0') + digits);
      const Quaterniond rotation = euler_rotation(root, {i * euler[0], i * euler[1], i * euler[2]});
      for (MjcfElement copy : element.children) {
        add_suffix(copy, "", names, suffixes.back());
        place(copy, {position, rotation}, inside);
        if (element.has("childclass")) give_class(copy, inside);
        out.push_back(std::move(copy));
      }
      position += rotation * Vector3d(offset[0], offset[1], offset[2]);
    }
    replicate_references(names, suffixes);
  }

  void add_suffix(MjcfElement& element, const std::string& section, const Names& names,
                  const std::string& suffix) {
    count(1, element);
    for_each_name(element, section, [&](const std::string& kind, std::string& value, bool) {
      if (names.contains({kind, value})) value += suffix;
    });
  }

  // Elements that refer to replicated ones are replicated too. The copies stand behind all others.
  void replicate_references(Names names, const std::vector<std::string>& suffixes) {
    for (const std::string kind : kSectionsThatRefer) {
      std::vector<MjcfElement> originals;
      MjcfElement* last = nullptr;
      for_each_section(root, kind, [&](MjcfElement& section) {
        last = &section;
        std::vector<MjcfElement> others;
        for (MjcfElement& one : section.children) {
          const bool is_one = refers(one, kind, names, false);
          if (is_one && one.has("name")) names.emplace(kind, one.text("name"));
          (is_one ? originals : others).push_back(std::move(one));
        }
        section.children = std::move(others);
      });
      for (const std::string& suffix : suffixes) {
        for (MjcfElement copy : originals) {
          add_suffix(copy, kind, names, suffix);
          last->children.push_back(std::move(copy));
        }
      }
    }
  }

  // Gives an element the place in its body that it has in a frame.
  void place(MjcfElement& element, const MjcfPose& frame, const std::string& inherited) const {
    const auto vector = [&](std::string_view attribute, const char* otherwise) {
      const std::string* text = classes_.find(element, attribute, inherited);
      const auto v = mjcf_numbers(element, text != nullptr ? *text : otherwise, 3, 3);
      return Vector3d(v[0], v[1], v[2]);
    };
    const auto set = [&](const char* attribute, const Vector3d& v) {
      element.set(attribute, std::span(v.data(), 3));
    };
    const bool may_have_ends = element.name == "geom" || element.name == "site";
    if (const std::string* ends =
            may_have_ends ? classes_.find(element, "fromto", inherited) : nullptr) {
      auto v = mjcf_numbers(element, *ends, 6, 6);
      for (const std::size_t end : {0U, 3U}) {
        Eigen::Map<Vector3d> point(v.data() + end);
        point = frame.position + frame.rotation * point;
      }
      element.set("fromto", v);
    } else if (may_have_ends || element.name == "body" || element.name == "camera") {
      const MjcfPose pose = frame * mjcf_pose(root, classes_, element, inherited);
      for (const char* attribute : kRotations) element.erase(attribute);
      const Quaterniond& q = pose.rotation;
      set("pos", pose.position);
      element.set("quat", std::array{q.w(), q.x(), q.y(), q.z()});
    } else if (element.name == "light" || element.name == "joint") {
      const char* direction = element.name == "light" ? "dir" : "axis";
      const std::string* type = classes_.find(element, "type", inherited);
      if (type != nullptr && *type == "free") return;
      set("pos", frame.position + frame.rotation * vector("pos", "0 0 0"));
      set(direction,
          frame.rotation * vector(direction, element.name == "light" ? "0 0 -1" : "0 0 1"));
    } else if (element.name == "composite" || element.name == "inertial") {
      element.fail("cannot be in a <frame> or <replicate> here");
    }
  }

  MjcfChanges& changes_;
  std::uint64_t most_;
  std::uint64_t elements_ = 0;  // with attached and copied ones
  std::set<fs::path> above_;
  MjcfClasses classes_;
  std::vector<MjcfElement> attached_;  // sections of attached models
};

}  // namespace

bool has_degrees(const MjcfElement& root) {
  return mjcf_compiler(root, "angle", "degree") == "degree";
}

MjcfPose operator*(const MjcfPose& first, const MjcfPose& second) {
  return {first.position + first.rotation * second.position, first.rotation * second.rotation};
}

MjcfPose inverse(const MjcfPose& pose) {
  const Quaterniond back = pose.rotation.conjugate();
  return {-(back * pose.position), back};
}

MjcfPose mjcf_pose(const MjcfElement& root, const MjcfClasses& classes, const MjcfElement& element,
                   const std::string& inherited) {
  const std::string* pos = classes.find(element, "pos", inherited);
  const auto p = mjcf_numbers(element, pos != nullptr ? *pos : "0 0 0", 3, 3);
  Quaterniond rotation = Quaterniond::Identity();
  const auto take = [&](auto&& find) {
    for (const char* kind : kRotations) {
      const std::string* text = find(kind);
      if (text == nullptr) continue;
      rotation = rotation_of(root, element, kind, *text);
      return true;
    }
    return false;
  };
  if (!take([&](const char* kind) { return element.find(kind); })) {
    take([&](const char* kind) { return classes.find(element, kind, inherited); });
  }
  return {Vector3d(p[0], p[1], p[2]), rotation};
}

MjcfElement flat_mjcf(const fs::path& file, std::uint64_t most_elements, MjcfChanges& changes) {
  return std::move(FlatMjcf(file, most_elements, changes).root);
}

}  // namespace breakwater
