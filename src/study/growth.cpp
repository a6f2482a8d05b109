#include <breakwater/study/growth.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace breakwater {
namespace {

constexpr std::size_t kExactDigits = 15;  // a double holds every number of so many digits

using Texts = std::vector<std::string>;

std::string change(const std::string& key, const std::string& then, const std::string& now) {
  const auto text = [](const std::string& value) { return value.empty() ? "not set" : value; };
  return then == now ? "" : fmt::format("{} is {}, and was {}", key, text(now), text(then));
}

// The first of `texts` that the others lack.
std::string missing(const std::string& key, const Texts& texts, const Texts& others,
                    const char* what = "left out") {
  const auto first = std::find_if(texts.begin(), texts.end(), [&](const std::string& text) {
    return std::find(others.begin(), others.end(), text) == others.end();
  });
  return first == texts.end() ? "" : fmt::format("{}: {} is {}", key, *first, what);
}

std::string joined(const Texts& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

Texts sets_of(const Study& study) {
  Texts sets;
  for (const std::string& set : study.sets) sets.push_back(comparable_set(set));
  return sets;
}

// The values of a key as [1, 2], or its distribution; empty without such a key.
Texts values_of(const std::vector<VariedKey>& keys, const std::string& name) {
  for (const VariedKey& key : keys) {
    if (key.key != name) continue;
    if (key.distribution) return {key.written};
    Texts values;
    for (const std::string& value : key.values) values.push_back(comparable(value));
    return values;
  }
  return {};
}

std::string change_of_keys(const std::string& table, const std::vector<VariedKey>& then,
                           const std::vector<VariedKey>& now, Method method) {
  Texts old_names, names;
  for (const VariedKey& key : then) old_names.push_back(key.key);
  for (const VariedKey& key : now) names.push_back(key.key);
  std::string reason = missing(table, old_names, names);
  if (reason.empty()) reason = missing(table, names, old_names, "new");
  // The place of a key is its coordinate.
  if (reason.empty() && draws(method)) reason = change(table, joined(old_names), joined(names));
  for (const std::string& name : old_names) {
    if (!reason.empty()) break;
    const std::string key = table + "." + name;
    const Texts old = values_of(then, name), is = values_of(now, name);
    const bool is_begin = is.size() >= old.size() && std::equal(old.begin(), old.end(), is.begin());
    if (method == Method::grid) {
      reason = missing(key, old, is);
    } else if (draws(method) || !is_begin) {
      reason = change(key, joined(old), joined(is));
    }
  }
  return reason;
}

Texts seeds_of(const Study& study) {
  Texts seeds;
  for (const std::uint64_t seed : study.seeds) seeds.push_back(std::to_string(seed));
  return seeds;
}

}  // namespace

std::string comparable(const std::string& value) {
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  const bool is_number = !value.empty() && *end == '\0' && value.size() <= kExactDigits;
  return is_number ? fmt::format("{}", number) : value;
}

std::string comparable_set(const std::string& set) {
  const std::size_t value = set.find('=') + 1;
  return set.substr(0, value) + comparable(set.substr(value));
}

std::string reason_against_growth(const Study& then, const Study& now) {
  Texts reasons = {
      change("scenario", then.scenario, now.scenario),
      missing("set", sets_of(then), sets_of(now)),
      missing("set", sets_of(now), sets_of(then), "new"),
      change("method", name_of(methods(), then.method), name_of(methods(), now.method)),
      missing("case", then.cases, now.cases),
      missing("seeds", seeds_of(then), seeds_of(now)),
      then.seeds.empty() ? change("seeds", "", joined(seeds_of(now))) : "",
      change_of_keys("compare", then.compare, now.compare, Method::grid),
      change_of_keys("vary", then.vary, now.vary, then.method)};
  if (draws(then.method)) {
    reasons.push_back(change("sampling_seed", std::to_string(then.sampling_seed),
                             std::to_string(now.sampling_seed)));
  }
  if (now.samples < then.samples) {
    reasons.push_back(change("samples", std::to_string(then.samples), std::to_string(now.samples)));
  } else if (then.method == Method::latin_hypercube && now.samples > then.samples) {
    reasons.push_back(
        fmt::format("samples: the points of lhs depend on their number, so none of "
                    "the {} is among {}",
                    then.samples, now.samples));
  }
  const auto first = std::find_if(reasons.begin(), reasons.end(),
                                  [](const std::string& reason) { return !reason.empty(); });
  return first == reasons.end() ? "" : *first;
}

}  // namespace breakwater
