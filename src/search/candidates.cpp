#include <breakwater/search/candidates.h>

#include <fmt/format.h>

#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace breakwater {

std::vector<std::string> candidate_lines(const TuningPlan& plan,
                                         const std::vector<std::size_t>& runs) {
  std::set<std::pair<std::size_t, std::size_t>> candidates;
  for (const std::size_t number : runs) {
    const TuningRun run = plan.run(number);
    candidates.emplace(run.tuned, run.evaluation);
  }
  std::vector<std::string> lines;
  for (const auto& [tuned, evaluation] : candidates) {
    lines.push_back(fmt::format("{}\t{}\t{}", tuned, evaluation,
                                fmt::join(plan.values_of(tuned, evaluation), "\t")));
  }
  return lines;
}

void begin_candidates(TuningPlan& plan, const std::vector<std::string>& lines,
                      const std::string& origin) {
  for (const std::string& line : lines) {
    std::istringstream parts(line);
    std::size_t tuned = 0;
    std::size_t evaluation = 0;
    parts >> tuned >> evaluation;
    parts.ignore();
    std::vector<std::string> values;
    for (std::string value; std::getline(parts, value, '\t');) values.push_back(value);
    const Tuning& tuning = plan.tuning();
    if (tuned >= tuning.cases.size() || evaluation >= tuning.budget ||
        values.size() != tuning.cases[tuned].search.size()) {
      throw std::invalid_argument(fmt::format("{}: has no candidate in: {}", origin, line));
    }
    plan.begin(tuned, evaluation, std::move(values));
  }
}

}  // namespace breakwater
