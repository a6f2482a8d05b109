#include <breakwater/study/key_effects.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <breakwater/config/toml_text.h>

namespace breakwater {
namespace {

// Whether, in a list, each value of `of` determines the value of `key`.
bool is_function_of(const VariedKey& key, const VariedKey& of) {
  std::map<std::string, std::string> value_at;
  for (std::size_t i = 0; i < of.values.size(); ++i) {
    if (value_at.emplace(of.values[i], key.values[i]).first->second != key.values[i]) return false;
  }
  return true;
}

// Whether the values of `coarse` form separate ranges when a list is sorted by `fine`. The list
// then cannot separate the effect of `coarse` from that of `fine`.
bool stands_apart(const VariedKey& coarse, const VariedKey& fine) {
  std::vector<std::pair<double, std::string>> along;
  std::set<std::string> different;
  for (std::size_t i = 0; i < fine.values.size(); ++i) {
    const auto number = number_in(fine.values[i]);
    if (!number) return false;
    along.emplace_back(*number, coarse.values[i]);
    different.insert(coarse.values[i]);
  }
  std::sort(along.begin(), along.end());
  std::size_t runs = 1;
  for (std::size_t i = 1; i < along.size(); ++i) runs += along[i].second != along[i - 1].second;
  return runs == different.size();
}

bool takes_several(const VariedKey& key) {
  return std::any_of(key.values.begin(), key.values.end(),
                     [&](const std::string& value) { return value != key.values.front(); });
}

}  // namespace

std::vector<StudyKey> study_keys(const Study& study) {
  std::vector<StudyKey> keys;
  for (const VariedKey& varied : study.vary) {
    StudyKey key;
    key.name = varied.key;
    key.is_number = std::all_of(varied.values.begin(), varied.values.end(),
                                [](const std::string& v) { return number_in(v).has_value(); });
    if (!key.is_number) {
      for (const std::string& value : varied.values) {
        const std::string text = plain_text(value);
        if (std::find(key.texts.begin(), key.texts.end(), text) == key.texts.end()) {
          key.texts.push_back(text);
        }
      }
    }
    keys.push_back(std::move(key));
  }
  return keys;
}

double key_number(const StudyKey& key, const std::string& value) {
  if (key.is_number) return *number_in(value);
  const auto found = std::find(key.texts.begin(), key.texts.end(), plain_text(value));
  return static_cast<double>(found - key.texts.begin());
}

std::vector<KeyEffect> key_effects(const Study& study) {
  const std::size_t keys = study.vary.size();
  const auto fixes = [&](std::size_t a, std::size_t b) {
    return study.method == Method::list && a != b && takes_several(study.vary[b]) &&
           is_function_of(study.vary[b], study.vary[a]) &&
           (is_function_of(study.vary[a], study.vary[b]) ||
            stands_apart(study.vary[b], study.vary[a]));
  };
  // If two keys determine each other, the first one leads.
  const auto leads = [&](std::size_t a, std::size_t b) {
    return fixes(a, b) && (a < b || !fixes(b, a));
  };
  std::vector<KeyEffect> effects;
  for (std::size_t a = 0; a < keys; ++a) {
    KeyEffect effect{a, {}, study.vary[a].key};
    bool is_led = false;
    std::vector<std::string> names;
    for (std::size_t b = 0; b < keys; ++b) {
      is_led = is_led || leads(b, a);
      if (!leads(a, b)) continue;
      effect.with.push_back(b);
      names.push_back(study.vary[b].key);
    }
    if (is_led) continue;
    if (!names.empty()) effect.name += fmt::format(" (with {})", fmt::join(names, ", "));
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace breakwater
