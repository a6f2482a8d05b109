#include <breakwater/plants/mjcf_tree.h>

#include <tinyxml2.h>

#include <set>

namespace breakwater {
namespace {

const std::set<std::string_view>& actuator_kinds() {
  static const std::set<std::string_view> kinds = {
      "general",  "motor",  "position", "velocity", "intvelocity", "damper",
      "cylinder", "muscle", "adhesion", "pid",      "dcmotor",     "orientation"};
  return kinds;
}

// The name of an element's kind in a <default>.
std::string_view kind_in_default(std::string_view name) {
  if (name == "spatial" || name == "fixed") return "tendon";
  return actuator_kinds().contains(name) ? "general" : name;
}

void print(const MjcfElement& element, tinyxml2::XMLPrinter& printer) {
  printer.OpenElement(element.name.c_str());
  for (const auto& [name, value] : element.attributes) {
    printer.PushAttribute(name.c_str(), value.c_str());
  }
  for (const MjcfElement& child : element.children) print(child, printer);
  printer.CloseElement();
}

}  // namespace

void MjcfChanges::add(MjcfChange::Loss loss, const std::string& what, const std::string& place) {
  for (MjcfChange& change : *this) {
    if (change.loss != loss || change.what != what) continue;
    ++change.count;
    return;
  }
  push_back({loss, what, place});
}

std::vector<double> mjcf_numbers(const MjcfElement& element, const std::string& text,
                                 std::size_t least, std::size_t most) {
  const auto numbers = read_numbers(text);
  if (!numbers || numbers->size() < least || numbers->size() > most) {
    element.fail("\"" + text + "\": needs " + std::to_string(least) +
                 (most > least ? " numbers or more"
                  : most > 1   ? " numbers"
                               : " number"));
  }
  return *numbers;
}

MjcfClasses::MjcfClasses(const MjcfElement& root) {
  MjcfElement main;  // all sections of the file are one
  for_each_section(root, "default", [&](const MjcfElement& section) {
    for (const MjcfElement& child : section.children) main.children.push_back(child);
    if (section.has("class")) main.set("class", section.text("class"));
  });
  add(main, {});
  classes_[""] = classes_[main.text("class", "main")];
}

void MjcfClasses::add(const MjcfElement& section, std::vector<MjcfElement> above) {
  for (const MjcfElement& child : section.children) {
    if (child.name != "default") above.push_back(child);
  }
  classes_[section.text("class", "main")] = above;
  for (const MjcfElement& child : section.children) {
    if (child.name == "default") add(child, above);
  }
}

std::vector<const MjcfElement*> MjcfClasses::defaults(const std::string& kind,
                                                      const std::string& name) const {
  std::vector<const MjcfElement*> found;
  const auto elements = classes_.find(name);
  if (elements == classes_.end()) return found;
  for (const MjcfElement& one : elements->second) {
    if (kind_in_default(one.name) == kind_in_default(kind)) found.push_back(&one);
  }
  return found;
}

const std::string* MjcfClasses::find(const MjcfElement& element, std::string_view attribute,
                                     const std::string& inherited) const {
  if (const std::string* own = element.find(attribute)) return own;
  const auto above = defaults(element.name, element.text("class", inherited));
  for (auto one = above.rbegin(); one != above.rend(); ++one) {
    if (const std::string* value = (*one)->find(attribute)) return value;
  }
  return nullptr;
}

std::string mjcf_compiler(const MjcfElement& root, std::string_view attribute,
                          const std::string& otherwise) {
  std::string value = otherwise;
  for_each_section(root, "compiler",
                   [&](const MjcfElement& section) { value = section.text(attribute, value); });
  return value;
}

std::string mjcf_text(const MjcfElement& root) {
  tinyxml2::XMLPrinter printer;
  print(root, printer);
  return printer.CStr();
}

}  // namespace breakwater
