#include "cli/mutants.h"
#include "catalogue.h"
#include "tables.h"

#include <regex>

#include <breakwater/experiment/scenario.h>

namespace breakwater::testing {
namespace {

// ---- broken input ------------------------------------------------------------------------------

// Damages to a file as a whole.
void add_broken_files(const Mutant& whole, const std::string& root, const std::string& wrong_root,
                      std::vector<Mutant>& mutants) {
  const std::string& text = whole.text;
  const auto add = [&](const std::string& change, const std::string& broken) {
    mutants.push_back({whole.scenario, whole.option, whole.file, "", change, broken});
  };
  add("empty", "");
  for (const std::size_t percent : {10, 25, 40, 50, 55}) {
    add("truncated", text.substr(0, text.size() * percent / 100));
  }
  std::string renamed = text;
  add("wrong root", renamed.replace(text.find(root), root.size(), wrong_root));
  for (const std::size_t part : {3, 2}) {
    const auto middle = static_cast<std::ptrdiff_t>(text.size() / part);
    std::string bytes = text;
    bytes.insert(bytes.begin() + middle, '\xff');
    add("broken UTF-8", bytes);
    bytes[static_cast<std::size_t>(middle)] = '\0';
    add("a NUL", bytes);
  }
}

std::vector<Mutant> scenario_mutants(const std::string& scenario) {
  const std::string text = text_of(source_file("scenarios/" + scenario + "/" + scenario + ".toml"));
  const Mutant whole{scenario, "--config", "mutant.toml", "", "", text};
  std::vector<Mutant> mutants;
  add_broken_files(whole, "\"" + scenario + "\"", "\"nonsense\"", mutants);
  std::istringstream lines(text);
  std::size_t at = 0;
  for (std::string line; std::getline(lines, line); at += line.size() + 1) {
    std::smatch match;
    if (!std::regex_match(line, match, std::regex(R"(([A-Za-z0-9_.]+)\s*=\s*(.+))"))) continue;
    const std::string key = match[1];
    const std::pair<const char*, std::string> changes[] = {
        {"misspelt", key + "x = " + match[2].str()},
        {"string", key + " = \"far\""},
        {"NaN", key + " = nan"},
        {"infinity", key + " = inf"},
        {"table", key + " = { a = 1 }"},
        {"duplicate", line + "\n" + line},
        {"no value", key + " ="}};
    for (const auto& [change, broken] : changes) {
      Mutant mutant = whole;
      mutant.place = key;
      mutant.change = change;
      mutant.text.replace(at, line.size(), broken);
      mutants.push_back(mutant);
    }
  }
  return mutants;
}

// The text with comments and declaration replaced by blanks, without a change of positions.
std::string without_comments(std::string text) {
  for (const auto& [begin, end] : {std::pair{"<!--", "-->"}, std::pair{"<?", "?>"}}) {
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
      const std::size_t stop = text.find(end, at) + std::string(end).size();
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(at),
                text.begin() + static_cast<std::ptrdiff_t>(stop), ' ');
    }
  }
  return text;
}

// The wrong values for an attribute, in place of its first number if it has one.
std::vector<std::pair<std::string, std::string>> changed_values(const std::string& value) {
  const std::string first = value.substr(0, value.find(' '));
  const std::string rest = value.substr(first.size());
  char* end = nullptr;
  const double number = std::strtod(first.c_str(), &end);
  const bool is_number = !first.empty() && *end == '\0';
  std::string negative = first.starts_with('-') ? first : "-" + first;
  if (!is_number || number == 0.0) negative = "-1";
  const auto with = [&](const std::string& word) { return is_number ? word + rest : word; };
  return {{"word", with("banana")},
          {"NaN", with("nan")},
          {"1e300", with("1e300")},
          {"negative", with(negative)}};
}

std::vector<Mutant> model_mutants(const std::string& file, const std::string& scenario) {
  const bool is_urdf = file.ends_with(".urdf");
  const std::string text = text_of(source_file("models/" + file));
  const Mutant whole{scenario,
                     is_urdf ? "model.urdf" : "model.mjcf",
                     is_urdf ? "mutant.urdf" : "mutant.xml",
                     "",
                     "",
                     text};
  std::vector<Mutant> mutants;
  const std::string root = is_urdf ? "<robot" : "<mujoco";
  add_broken_files(whole, root, "<nonsense", mutants);
  const std::string code = without_comments(text);
  const std::regex attribute(R"re(\s([a-z0-9]+)="([^"]*)")re");
  for (std::sregex_iterator i(code.begin(), code.end(), attribute), end; i != end; ++i) {
    const auto at = static_cast<std::size_t>(i->position(2));
    const std::size_t open = code.rfind('<', at) + 1;
    const std::string element = code.substr(open, code.find_first_of(" \n/>", open) - open);
    for (const auto& [change, value] : changed_values((*i)[2])) {
      if (value == (*i)[2]) continue;  // already negative
      Mutant mutant = whole;
      mutant.place = "<" + element + "> " + (*i)[1].str();
      mutant.change = change;
      mutant.text.replace(at, static_cast<std::size_t>(i->length(2)), value);
      mutants.push_back(mutant);
    }
  }
  return mutants;
}

}  // namespace

std::vector<Mutant> all_mutants() {
  std::vector<Mutant> all;
  const auto add = [&all](const std::vector<Mutant>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  for (const std::string& scenario : catalogue().names<ScenarioKind>())
    add(scenario_mutants(scenario));
  add(model_mutants("arm.xml", "arm_wall_contact"));
  add(model_mutants("arm.urdf", "arm_push"));
  add(model_mutants("cart.xml", "cart_estimation"));
  add(model_mutants("motor.xml", "motor_estimation"));
  add(model_mutants("quadrotor.xml", "quadrotor_waves"));
  return all;
}

const std::vector<Legal>& legal_reasons() {
  static const std::vector<Legal> all = [] {
    std::vector<Legal> reasons;
    for (const auto& row : rows_of("LegalMutants")) {
      reasons.push_back({row.at(0), row.at(1), row.at(2), row.at(3)});
    }
    return reasons;
  }();
  return all;
}

const Legal* find_legal(const Mutant& mutant) {
  const auto fits = [&](const Legal& legal) {
    return std::regex_match(mutant.option, std::regex(legal.option)) &&
           std::regex_match(mutant.place, std::regex(legal.place)) &&
           std::regex_match(mutant.change, std::regex(legal.change));
  };
  const auto found = std::find_if(legal_reasons().begin(), legal_reasons().end(), fits);
  return found != legal_reasons().end() ? &*found : nullptr;
}

}  // namespace breakwater::testing
