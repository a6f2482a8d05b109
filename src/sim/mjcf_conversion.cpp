#include <breakwater/sim/mjcf_conversion.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/mjcf_rules.h>

namespace breakwater {
namespace {

using Loss = MjcfChange::Loss;

constexpr const char* kGravityColumn = "breakwater_gravcomp";
constexpr const char* kSlackColumn = "breakwater_springlength";

// "PARENT/ELEMENT" and its attributes. The text has an element in each line, indented by 3 blanks
// below its parent; its attributes go on in lines that begin with 30.
using Schema = std::map<std::string, std::set<std::string, std::less<>>>;

const Schema& engine_schema() {
  static const Schema schema = [] {
    std::vector<char> text(100000);
    mj_printSchema(nullptr, text.data(), static_cast<int>(text.size()), 0, 0);
    Schema found;
    std::vector<std::string> path;
    std::set<std::string, std::less<>>* attributes = nullptr;
    std::istringstream lines(text.data()), words;
    for (std::string line, word; std::getline(lines, line);) {
      const std::size_t indent = line.find_first_not_of(' ');
      if (indent == std::string::npos) continue;
      words.clear();
      words.str(line);
      if (indent < 30) {
        words >> word;
        path.resize(indent / 3);
        path.push_back(word == "(world)body" ? "body" : word);
        attributes = &found[(path.size() < 2 ? "" : path[path.size() - 2]) + "/" + path.back()];
        words >> word;  // how often it may occur
      }
      while (words >> word) attributes->insert(word);
    }
    for (const std::string own : {"body", "default"}) {  // they contain themselves
      found[own + "/" + own] = found["mujoco/" + own];
    }
    return found;
  }();
  return schema;
}

// A shortcut for a servo as MuJoCo 3 reads it (mjs_setToPosition and its like): each one changes
// some numbers of its class.
struct Servo {
  double gain = 1.0;
  std::array<double, 3> bias = {};  // bias[2] > 0: a damping ratio
  std::string dynamics = "none";
  double time_constant_s = 1.0;
  double inherited_range = 0.0;
  bool is_new = false;  // has what the engine's shortcuts lack

  void read(const MjcfElement& e) {
    const auto take = [&](const char* attribute, double& value) {
      const std::string* text = e.find(attribute);
      if (text != nullptr) value = mjcf_numbers(e, *text, 1, 1)[0];
      return text != nullptr;
    };
    if (e.name == "general") {
      if (const std::string* text = e.find("gainprm")) gain = mjcf_numbers(e, *text, 1, 10)[0];
      if (const std::string* text = e.find("biasprm")) {
        const auto numbers = mjcf_numbers(e, *text, 1, 10);
        std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 3), bias.begin());
      }
      if (const std::string* text = e.find("dynprm")) {
        time_constant_s = mjcf_numbers(e, *text, 1, 10)[0];
      }
      dynamics = e.text("dyntype", dynamics);
    } else if (e.name == "motor") {
      gain = 1.0;
      dynamics = "none";
    } else if (e.name == "velocity") {
      take("kv", gain);
      bias[2] = -gain;
      dynamics = "none";
    } else if (e.name == "position" || e.name == "intvelocity") {
      take("kp", gain);
      bias[1] = -gain;
      double number = 0.0;
      if (take("kv", number)) bias[2] = -number;
      if (take("dampratio", number)) bias[2] = number;
      is_new |= e.has("kv") || e.has("dampratio");
      if (e.name == "intvelocity") dynamics = "integrator";
      if (take("timeconst", time_constant_s)) {
        dynamics = time_constant_s == 0.0 ? "none" : "filterexact";
        is_new = true;
      }
      is_new |= take("inheritrange", inherited_range);
    }
  }
};

class Conversion {
 public:
  Conversion(const std::string& file, std::uint64_t most_elements)
      : root(flat_mjcf(file, most_elements, changes)), file_(file) {
    if (root.name != "mujoco") return;
    classes_ = MjcfClasses(root);
    for_each_element(root, [&](MjcfElement& one, MjcfElement& parent, const std::string& name) {
      const bool is_tendon = parent.name == "tendon";
      const bool is_in_body = parent.name == "body" || parent.name == "worldbody";
      if (!one.has("name") || !(is_tendon || is_in_body)) return;
      named_[{is_tendon ? "tendon" : one.name, one.text("name")}] = {&one, &parent, name};
    });
    convert_servos();
    limit_joint_forces();
    join_sites();
    compensate_gravity();
    convert_slack();
    widen_margins();
    give_sizes();
    set_autolimits();
    check(root, "");
    if (has_damping_ratio_) resolve_damping_ratios();
  }

  MjcfChanges changes;
  MjcfElement root;

 private:
  struct Named {
    MjcfElement* element = nullptr;
    MjcfElement* parent = nullptr;
    std::string inherited;
  };

  const Named* named(const std::string& kind, const std::string& name) const {
    const auto found = named_.find({kind, name});
    return found == named_.end() ? nullptr : &found->second;
  }

  MjcfElement& new_section(const char* name, const char* child) {
    root.children.push_back({name, file_, {}, {{child, file_, {}, {}}}});
    return root.children.back().children.front();
  }

  template <typename Visit>
  void for_each_actuator(Visit&& visit) {
    for_each_section(root, "actuator", [&](MjcfElement& section) {
      for (MjcfElement& actuator : section.children) visit(actuator);
    });
  }

  // A range [lower, upper] of an element, in rad or m; nothing if there is none.
  std::optional<std::vector<double>> range(const Named& one, const char* attribute) const {
    const std::string* text = classes_.find(*one.element, attribute, one.inherited);
    if (text == nullptr) return std::nullopt;
    return mjcf_numbers(*one.element, *text, 2, 2);
  }

  void convert_servos() {
    for_each_element(root, [&](MjcfElement& one, MjcfElement& parent, const std::string& own) {
      if (one.name != "position" && one.name != "intvelocity") return;
      const bool is_default = parent.name == "default";
      Servo servo;
      for (const MjcfElement* above :
           classes_.defaults(one.name, is_default ? own : one.text("class"))) {
        servo.read(*above);
      }
      if (!is_default) servo.read(one);
      if (servo.is_new) write_servo(one, servo, is_default);
    });
  }

  void write_servo(MjcfElement& one, const Servo& servo, bool is_default) {
    for (const char* attribute : {"kv", "dampratio", "timeconst", "inheritrange"}) {
      if (one.has(attribute)) changes.add(Loss::none, one.name + " " + attribute, one.place);
      one.erase(attribute);
    }
    one.erase("kp");
    const bool integrates = one.name == "intvelocity";
    if (servo.inherited_range > 0.0 && !is_default) {
      one.set(integrates ? "actrange" : "ctrlrange", inherited_range(one, servo.inherited_range));
      if (!integrates) one.set("ctrllimited", "true");
    }
    if (integrates) one.set("actlimited", "true");
    has_damping_ratio_ |= servo.bias[2] > 0.0;
    one.name = "general";
    one.set("gaintype", "fixed");
    one.set("biastype", "affine");
    one.set("gainprm", std::array{servo.gain});
    one.set("biasprm", servo.bias);
    one.set("dyntype", servo.dynamics);
    one.set("dynprm", std::array{servo.time_constant_s});
  }

  std::array<double, 2> inherited_range(const MjcfElement& actuator, double part) {
    const std::string kind = actuator.has("joint") ? "joint" : "tendon";
    const Named* driven = named(kind, actuator.text(kind));
    const auto whole = driven != nullptr ? range(*driven, "range") : std::nullopt;
    if (!whole) actuator.fail("inheritrange: its joint or tendon has no range");
    double unit = 1.0;
    if (kind == "joint" && has_degrees(root)) {
      const std::string* type = classes_.find(*driven->element, "type", driven->inherited);
      if (type == nullptr || *type == "hinge") unit = std::numbers::pi / 180.0;
    }
    const double middle = 0.5 * unit * ((*whole)[0] + (*whole)[1]);
    const double half = 0.5 * unit * part * ((*whole)[1] - (*whole)[0]);
    return {middle - half, middle + half};
  }

  // A limit of the force on a joint becomes that of its only actuator.
  void limit_joint_forces() {
    for (auto& [key, joint] : named_) {
      if (key.first == "joint") limit_joint_force(joint);
    }
    // A joint without a name has no actuator.
    for_each_element(root, [](MjcfElement& one, MjcfElement&, const std::string&) {
      if (one.name == "joint") one.erase("actuatorfrcrange");
    });
  }

  void limit_joint_force(const Named& joint) {
    const MjcfElement& e = *joint.element;
    const auto limits = range(joint, "actuatorfrcrange");
    const std::string* limited = classes_.find(e, "actuatorfrclimited", joint.inherited);
    if (!limits || (limited != nullptr && *limited == "false")) return;
    std::vector<MjcfElement*> drivers;
    bool may_have_others = false;
    for_each_actuator([&](MjcfElement& actuator) {
      if (actuator.text("joint", actuator.text("jointinparent")) == e.text("name")) {
        drivers.push_back(&actuator);
      }
      may_have_others |= !actuator.has("joint") && !actuator.has("jointinparent") &&
                         may_drive(actuator, e.text("name"));
    });
    if (drivers.size() > 1 || may_have_others) {
      changes.add(Loss::dropped, "joint actuatorfrcrange", e.place);
      return;
    }
    changes.add(Loss::none, "joint actuatorfrcrange", e.place);
    if (drivers.empty()) return;
    MjcfElement& driver = *drivers.front();
    const std::string* gears = classes_.find(driver, "gear");
    const double gear = gears != nullptr ? mjcf_numbers(driver, *gears, 1, 6)[0] : 1.0;
    if (gear == 0.0) return;
    std::array<double, 2> force = {(*limits)[0] / gear, (*limits)[1] / gear};
    if (gear < 0.0) std::swap(force[0], force[1]);
    const std::string* own_limited = classes_.find(driver, "forcelimited");
    const auto own = range({&driver, nullptr, ""}, "forcerange");
    if (own && (own_limited == nullptr || *own_limited != "false")) {
      force = {std::max(force[0], (*own)[0]), std::min(force[1], (*own)[1])};
    }
    driver.set("forcerange", force);
    driver.set("forcelimited", "true");
  }

  // Whether an actuator without a joint may act on one: fixed tendons name their joints.
  bool may_drive(const MjcfElement& actuator, const std::string& joint) const {
    const Named* tendon = named("tendon", actuator.text("tendon"));
    if (tendon == nullptr || tendon->element->name != "fixed") return true;
    const auto& joints = tendon->element->children;
    return std::any_of(joints.begin(), joints.end(),
                       [&](const MjcfElement& one) { return one.text("joint") == joint; });
  }

  // Two sites become two bodies and a relative pose. A <connect> is a <weld> that turns freely, so
  // that the sites need not meet at the reference pose.
  void join_sites() {
    for_each_element(root, [&](MjcfElement& one, MjcfElement&, const std::string&) {
      if (!one.has("site1") || !one.has("site2")) return;
      std::array<MjcfPose, 2> poses;
      for (const int i : {0, 1}) {
        const std::string attribute = i == 0 ? "site1" : "site2";
        const Named* site = named("site", one.text(attribute));
        if (site == nullptr) one.fail("there is no site \"" + one.text(attribute) + "\"");
        poses[static_cast<std::size_t>(i)] =
            mjcf_pose(root, classes_, *site->element, site->inherited);
        one.set(i == 0 ? "body1" : "body2", name_of(*site->parent));
        one.erase(attribute);
      }
      const bool is_weld = one.name == "weld";
      changes.add(is_weld ? Loss::dropped : Loss::approximated,
                  is_weld ? "weld of sites (the engine weighs its rotation otherwise)"
                          : "connect of sites (equal at rest)",
                  one.place);
      const Eigen::Vector3d& p = poses[0].position;
      const Eigen::Quaterniond q = (poses[0] * inverse(poses[1])).rotation;
      one.set("relpose", std::array{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
      one.set("anchor", std::span(poses[1].position.data(), 3));
      if (!is_weld) one.set("torquescale", "0");
      one.name = "weld";
    });
  }

  std::string name_of(MjcfElement& body) {
    if (body.name == "worldbody") return "world";
    if (!body.has("name")) body.set("name", "breakwater_body_" + std::to_string(++unnamed_));
    return body.text("name");
  }

  // Puts numbers behind the user data of elements, all in the same column, and notes the column.
  void add_user_data(const std::vector<std::pair<MjcfElement*, std::vector<double>>>& rows,
                     std::size_t used, const char* size, const char* name) {
    const auto padded = [&](const MjcfElement& e) {
      const std::string* own = classes_.find(e, "user");
      auto numbers = own != nullptr ? mjcf_numbers(e, *own, 0, used) : std::vector<double>();
      numbers.resize(used);
      return numbers;
    };
    for (const auto& [element, added] : rows) {
      std::vector<double> numbers = padded(*element);
      numbers.insert(numbers.end(), added.begin(), added.end());
      element->set("user", numbers);
    }
    MjcfElement& column = new_section("custom", "numeric");
    column.set("name", name);
    column.set("data", std::to_string(used));
    for_each_section(root, "size", [&](MjcfElement& section) { section.erase(size); });
  }

  std::size_t user_size(const MjcfElement& e, std::size_t least) const {
    const std::string* own = classes_.find(e, "user");
    return own == nullptr ? least : std::max(least, mjcf_numbers(e, *own, 0, 1000).size());
  }

  std::size_t stated_size(const char* attribute) {
    double stated = 0.0;
    for_each_section(root, "size", [&](const MjcfElement& section) {
      if (const std::string* text = section.find(attribute)) {
        stated = std::max(stated, mjcf_numbers(section, *text, 1, 1)[0]);
      }
    });
    return static_cast<std::size_t>(stated);
  }

  void compensate_gravity() {
    std::vector<std::pair<MjcfElement*, std::vector<double>>> rows;
    std::size_t used = stated_size("nuser_body");
    for_each_element(root, [&](MjcfElement& body, MjcfElement&, const std::string&) {
      if (body.name != "body") return;
      used = user_size(body, used);
      const double part = mjcf_numbers(body, body.text("gravcomp", "0"), 1, 1)[0];
      body.erase("gravcomp");
      if (part == 0.0) return;
      rows.push_back({&body, {part}});
      changes.add(Loss::none, "body gravcomp", body.place);
    });
    if (!rows.empty()) add_user_data(rows, used, "nuser_body", kGravityColumn);
  }

  // A spring of a tendon that is slack between two lengths.
  void convert_slack() {
    std::vector<std::pair<MjcfElement*, std::vector<double>>> rows;
    std::size_t used = stated_size("nuser_tendon");
    for_each_element(root, [&](MjcfElement& tendon, MjcfElement& parent, const std::string&) {
      if (parent.name != "tendon") return;
      used = user_size(tendon, used);
      const std::string* text = classes_.find(tendon, "springlength");
      if (text == nullptr) return;
      const auto lengths = mjcf_numbers(tendon, *text, 1, 2);
      if (lengths.size() < 2) return;
      changes.add(Loss::none, "tendon springlength", tendon.place);
      tendon.set("springlength", std::array{lengths[0]});
      const std::string* stiffness = classes_.find(tendon, "stiffness");
      if (lengths[0] == lengths[1] || stiffness == nullptr) return;
      rows.push_back(
          {&tendon, {mjcf_numbers(tendon, *stiffness, 1, 1)[0], lengths[0], lengths[1]}});
      tendon.set("stiffness", "0");
    });
    if (!rows.empty()) add_user_data(rows, used, "nuser_tendon", kSlackColumn);
  }

  // A gap beyond the margin has no meaning in the engine. In MuJoCo 3 it lies outside of the
  // margin.
  void widen_margins() {
    for_each_element(
        root, [&](MjcfElement& one, MjcfElement& parent, const std::string& inherited) {
          if (parent.name == "default" || (one.name != "geom" && one.name != "pair")) return;
          const std::string* gap = classes_.find(one, "gap", inherited);
          const std::string* margin = classes_.find(one, "margin", inherited);
          if (gap == nullptr) return;
          const double outside = mjcf_numbers(one, *gap, 1, 1)[0];
          const double inside = margin != nullptr ? mjcf_numbers(one, *margin, 1, 1)[0] : 0.0;
          if (outside <= inside) return;
          one.set("margin", std::array{inside + outside});
          changes.add(Loss::none, one.name + " gap", one.place);
        });
  }

  // MuJoCo 3 has one memory for all. In the engine the stack, contacts and constraints each have a
  // fixed size. The square of the constraints, with 12 bytes each, takes most of theirs.
  void give_sizes() {
    constexpr double kMostNumbers = 0x1p27;  // 1 GB, which costs what is used of it
    constexpr double kLeastRows = 500;       // without `njmax`
    constexpr double kMostRows = 4096;       // 200 MB, which cost all
    for_each_section(root, "size", [&](MjcfElement& size) {
      std::string memory = size.text("memory", "-1");
      const auto unit = std::string("KMG").find(static_cast<char>(std::toupper(memory.back())));
      if (unit != std::string::npos) memory.pop_back();
      double bytes = mjcf_numbers(size, memory, 1, 1)[0];
      if (unit != std::string::npos) bytes *= static_cast<double>(1LL << (10 * (unit + 1)));
      if (bytes <= 0.0) return;
      const double numbers = std::min(kMostNumbers, std::ceil(bytes / sizeof(mjtNum)));
      const double rows = std::clamp(std::sqrt(numbers / 2.0), kLeastRows, kMostRows);
      for (const auto& [name, count] :
           {std::pair("nstack", numbers), {"njmax", rows}, {"nconmax", rows}}) {
        if (!size.has(name)) size.set(name, std::to_string(static_cast<int>(count)));
      }
    });
  }

  // The engine asks for `limited` wherever there is a range, unless `autolimits` is set.
  void set_autolimits() {
    if (!mjcf_compiler(root, "autolimits", "").empty()) return;
    std::string place;
    for_each_element(root, [&](MjcfElement& one, MjcfElement&, const std::string& inherited) {
      const bool has_range = one.name == "joint" || one.name == "spatial" || one.name == "fixed" ||
                             one.name == "tendon";
      const bool is_free = one.name == "damper" || one.name == "adhesion";  // always limited
      for (const auto& [range, limited] : {std::pair("range", "limited"),
                                           {"ctrlrange", "ctrllimited"},
                                           {"forcerange", "forcelimited"},
                                           {"actrange", "actlimited"}}) {
        if (!one.has(range) || (!has_range && range == std::string("range"))) continue;
        if (is_free && range == std::string("ctrlrange")) continue;
        if (classes_.find(one, limited, inherited) == nullptr) place = one.place;
      }
    });
    if (place.empty()) return;
    changes.add(Loss::none, "compiler autolimits", place);
    root.children.insert(root.children.begin(), {"compiler", place, {{"autolimits", "true"}}, {}});
  }

  static const mjcf::Rule* rule(const std::string& element, const std::string& attribute) {
    for (const mjcf::Rule& one : mjcf::kRules) {
      const bool is_for_it = one.element.empty() || mjcf::has_word(one.element, element);
      const bool is_it =
          attribute.empty() ? one.attribute.empty() : mjcf::has_word(one.attribute, attribute);
      if (is_for_it && is_it) return &one;
    }
    return nullptr;
  }

  void note(mjcf::Fate fate, std::string what, std::string_view words, const std::string& place) {
    if (!words.empty()) what.append(" (").append(words).append(")");
    changes.add(fate == mjcf::approximated ? Loss::approximated
                : fate == mjcf::dropped    ? Loss::dropped
                                           : Loss::none,
                what, place);
  }

  // Applies the rule for an attribute, or for the element if the attribute is "". Returns true.
  bool leaves_out(const MjcfElement& e, const std::string& attribute, const std::string& value) {
    const std::string name = attribute.empty() ? "" : attribute + ": ";
    const mjcf::Rule* found = rule(e.name, attribute);
    if (found == nullptr) e.fail(name + "neither MuJoCo 2.2 nor the conversion knows it");
    const std::vector<std::string> words = words_of(value);
    const bool is_harmless = !words.empty() && std::ranges::all_of(words, [&](const auto& word) {
      return mjcf::has_word(found->harmless, word);
    });
    if (found->fate == mjcf::refused && !is_harmless) {
      e.fail(name + "MuJoCo 2.2 does not have it" + (found->words.empty() ? "" : "; ") +
             std::string(found->words));
    }
    note(is_harmless ? mjcf::left_out : found->fate,
         e.name + (attribute.empty() ? "" : " ") + attribute, is_harmless ? "" : found->words,
         e.place);
    return true;
  }

  void change_words(MjcfElement& e) {
    for (auto& [attribute, value] : e.attributes) {
      for (const mjcf::Keyword& one : mjcf::kKeywords) {
        const bool is_name = one.value.empty();
        if (one.element != e.name || one.attribute != attribute) continue;
        if (!is_name && one.value != value) continue;
        const std::string becomes(one.becomes);
        if (one.fate == mjcf::refused) e.fail(value + ": " + becomes);
        note(one.fate, e.name + " " + attribute + (is_name ? "" : " " + value),
             is_name ? "" : "is " + becomes, e.place);
        (is_name ? attribute : value) = becomes;
      }
    }
  }

  void check(MjcfElement& e, const std::string& parent) {
    const std::string name = schema_name(e);
    const auto& known = engine_schema().at(parent + "/" + name);
    change_words(e);
    std::erase_if(e.attributes, [&](const auto& one) {
      return !known.contains(one.first) && leaves_out(e, one.first, one.second);
    });
    std::vector<MjcfElement> kept;
    for (MjcfElement& child : e.children) {
      if (engine_schema().contains(name + "/" + schema_name(child))) {
        check(child, name);
        kept.push_back(std::move(child));
      } else {
        leaves_out(child, "", "");
      }
    }
    e.children = std::move(kept);
  }

  static std::string schema_name(const MjcfElement& e) {
    return e.name == "worldbody" ? "body" : e.name;
  }

  // kv = 2 ζ √(kp m) with the inertia m at the reference pose, as in MuJoCo 3 (mj_setConst).
  void resolve_damping_ratios() {
    std::string reason;
    const ModelPointer model = load_mjcf(file_, mjcf_text(root), reason);
    if (model == nullptr) return;  // the caller's own call gives the reason
    const DataPointer data(mj_makeData(model.get()));
    call_engine([&] { mj_forward(model.get(), data.get()); });
    int i = 0;
    for_each_actuator([&](MjcfElement& actuator) {
      const double gain = model->actuator_gainprm[mjNGAIN * i];
      double* bias = model->actuator_biasprm + static_cast<std::ptrdiff_t>(mjNBIAS) * i;
      if (gain == -bias[1] && bias[2] > 0.0) {
        double inertia = 0.0;
        for (int dof = 0; dof < model->nv; ++dof) {
          const double moment = data->actuator_moment[i * model->nv + dof];
          if (moment * moment > mjMINVAL) inertia += model->dof_M0[dof] / (moment * moment);
        }
        bias[2] = -2.0 * bias[2] * std::sqrt(gain * inertia);
        actuator.set("biasprm", std::span<const double>(bias, 3));
      }
      ++i;
    });
  }

  std::string file_;
  MjcfClasses classes_;
  std::map<std::pair<std::string, std::string>, Named> named_;  // by kind and name
  bool has_damping_ratio_ = false;
  int unnamed_ = 0;
};

// mjcb_passive: forces that the engine does not have.
void missing_forces(const mjModel* m, mjData* d) {
  if (m->nnumeric == 0) return;
  const auto column = [m](const char* name) {
    const int id = mj_name2id(m, mjOBJ_NUMERIC, name);
    return id < 0 ? -1 : static_cast<int>(m->numeric_data[m->numeric_adr[id]]);
  };
  const int gravity = (m->opt.disableflags & mjDSBL_GRAVITY) == 0 ? column(kGravityColumn) : -1;
  for (int body = 1; gravity >= 0 && body < m->nbody; ++body) {
    const mjtNum part = m->body_user[body * m->nuser_body + gravity];
    if (part == 0.0) continue;
    mjtNum force[3];
    const mjtNum torque[3] = {0.0, 0.0, 0.0};
    mju_scl3(force, m->opt.gravity, -part * m->body_mass[body]);
    mj_applyFT(m, d, force, torque, d->xipos + static_cast<std::ptrdiff_t>(3) * body, body,
               d->qfrc_passive);
  }
  const int slack = column(kSlackColumn);
  for (int tendon = 0; slack >= 0 && tendon < m->ntendon; ++tendon) {
    const mjtNum* spring =
        m->tendon_user + static_cast<std::ptrdiff_t>(tendon) * m->nuser_tendon + slack;
    const mjtNum length = d->ten_length[tendon];
    const mjtNum force = spring[0] * (length > spring[2]   ? spring[2] - length
                                      : length < spring[1] ? spring[1] - length
                                                           : 0.0);
    if (force == 0.0) continue;
    const bool is_sparse = mj_isSparse(m) != 0;
    const int start = is_sparse ? d->ten_J_rowadr[tendon] : tendon * m->nv;
    const int count = is_sparse ? d->ten_J_rownnz[tendon] : m->nv;
    for (int i = 0; i < count; ++i) {
      d->qfrc_passive[is_sparse ? d->ten_J_colind[start + i] : i] += force * d->ten_J[start + i];
    }
  }
}

}  // namespace

ConvertedMjcf convert_mjcf(const std::string& file, std::uint64_t most_elements) {
  Conversion conversion(file, most_elements);
  return {std::move(conversion.root), std::move(conversion.changes)};
}

std::vector<std::string> conversion_warnings(const std::string& file) {
  MjcfChanges changes;
  try {
    changes = convert_mjcf(file, std::numeric_limits<std::uint64_t>::max()).changes;
  } catch (const std::invalid_argument&) {
    return {};  // another kind of file
  }
  if (changes.empty()) return {};
  std::string line;
  for (const auto& [loss, words] : {std::pair(Loss::dropped, "dropped: "),
                                    {Loss::approximated, "approximated: "},
                                    {Loss::none, "without loss: "}}) {
    std::string names;
    for (const MjcfChange& change : changes) {
      if (change.loss == loss) names += (names.empty() ? words : ", ") + change.what;
    }
    if (!names.empty()) line += (line.empty() ? "" : "; ") + names;
  }
  return {file + ": converted from MuJoCo 3; " + line};
}

ModelPointer load_mjcf(const std::string& file, const std::string& text, std::string& reason) {
  char error[1000] = "";
  ModelPointer model;
  std::unique_ptr<mjVFS> files;  // 2 MB
  if (!text.empty()) {
    files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), file.c_str(), static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
  }
  {
    // The engine's XML reader changes the locale of the process, so it must not run twice at once.
    static std::mutex loading;
    const std::lock_guard lock(loading);
    reason = call_engine(
        [&] { model.reset(mj_loadXML(file.c_str(), files.get(), error, sizeof(error))); });
  }
  if (files) mj_deleteVFS(files.get());
  if (model == nullptr && reason.empty()) reason = error;
  return model;
}

void add_missing_forces(const mjModel& model) {
  for (const char* column : {kGravityColumn, kSlackColumn}) {
    if (mj_name2id(&model, mjOBJ_NUMERIC, column) < 0) continue;
    static std::once_flag once;
    std::call_once(once, [] { mjcb_passive = &missing_forces; });
  }
}

}  // namespace breakwater
