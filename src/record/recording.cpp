#include <breakwater/record/recording.h>

#include <algorithm>
#include <stdexcept>

namespace breakwater {

const Track& Recording::track(const std::string& name) const {
  const auto found =
      std::find_if(tracks.begin(), tracks.end(), [&](const Track& t) { return t.name() == name; });
  if (found == tracks.end()) throw std::out_of_range("recording has no track " + name);
  return *found;
}

std::optional<double> Recording::metric(const std::string& name) const {
  const auto found =
      std::find_if(metrics.begin(), metrics.end(), [&](const Metric& m) { return m.name == name; });
  if (found == metrics.end()) return std::nullopt;
  return found->value;
}

}  // namespace breakwater
