#include <breakwater/study/isolated.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

// A large number, so that the start of a process and its look at finished points cost little. A
// copy of this process has a single point: parts in Python begin each run as they were given.
std::size_t most_points_of_a_child() {
  return start_copy == nullptr ? 1000 : 1;
}

// The state that all threads of run_isolated() share. Each thread has one child at a time.
class Children {
 public:
  Children(const std::vector<std::size_t>& points, const PointSource& source,
           const StudyFolder& folder, Shard& shard, const ExecutorOptions& options)
      : points_(points), source_(source), folder_(folder), shard_(shard), options_(options) {}

  // Runs points[begin] to points[end - 1] with as many children as necessary.
  void run(std::size_t begin, std::size_t end) {
    try {
      while (begin < end && !is_stopped_) begin = run_child(begin, end);
    } catch (...) {
      is_stopped_ = true;  // stops the other children too
      throw;
    }
  }

 private:
  // Returns where the next child continues.
  std::size_t run_child(std::size_t begin, std::size_t end) {
    const std::vector<std::size_t> rest(points_.begin() + static_cast<std::ptrdiff_t>(begin),
                                        points_.begin() + static_cast<std::ptrdiff_t>(end));
    std::vector<std::string> words = {own_program(),
                                      folder_.kind().command,
                                      folder_.path().string(),
                                      "--points",
                                      print_points(rest),
                                      "--jobs",
                                      "1",
                                      "--quiet"};
    for (std::string& word : source_.task_words(rest)) words.push_back(std::move(word));
    std::size_t next = begin;
    ProcessResults written;
    EndedProgram ended = run_beside(words, [&](ReadProgram& child) {
      const std::size_t before = written.results.size();
      written = results_of_process(folder_.shards(), child.process(), std::move(written));
      for (std::size_t i = before; i < written.results.size(); ++i) {
        // An earlier process may have had the same process number.
        const PointResult& result = written.results[i];
        const std::size_t nth = place_of(result.number, begin, end);
        if (nth == end || result.asked != asked_of(origin_, source_.asked(result.number))) continue;
        next = nth + 1;
        finish(nth, result);
      }
      if (has_to_stop()) child.interrupt();
    });
    // A child that was still loading ends by the signal without a message.
    const bool has_stopped = has_to_stop();
    const std::optional<int> status = ended.exit_status();
    const bool is_over = status && (*status == kInterrupted || *status == kRunFailed);
    if (is_over || status == kUsage) {
      const std::string reason = ended.take_reason();
      ended.repeat_said();
      if (!is_over && !has_stopped) throw std::invalid_argument(reason);
      is_stopped_ = true;
      return end;
    }
    ended.repeat_said();
    if (has_stopped || next == end || status == kSuccess) return end;
    // The child may have left out points that another process did.
    const std::size_t at = written.begun ? place_of(*written.begun, next, end) : end;
    if (status || at == end) {
      throw std::invalid_argument("--isolate: a process of the study ended with " + ended.end());
    }
    PointResult lost;
    lost.number = points_[at];
    lost.key = written.begun_key;
    lost.asked = source_.asked(lost.number);
    if (ended.has_crashed()) {
      if (lost.key.empty()) lost.key = source_.unprepared_key(lost.number);
      lost.status = PointStatus::crashed;
      lost.reason = ended.end();
      shard_.add(lost);
      finish(at, lost);
    } else {
      fmt::print(stderr, "{}: point {} is left undone: its process was ended by {}\n",
                 folder_.kind().command, lost.key.empty() ? std::to_string(lost.number) : lost.key,
                 ended.end());
    }
    return at + 1;
  }

  // The index of a point, searched from points[begin] on; `end` if it is not there.
  std::size_t place_of(std::size_t point, std::size_t begin, std::size_t end) const {
    const auto first = points_.begin();
    const auto last = first + static_cast<std::ptrdiff_t>(end);
    const auto found = std::lower_bound(first + static_cast<std::ptrdiff_t>(begin), last, point);
    return found != last && *found == point ? static_cast<std::size_t>(found - first) : end;
  }

  void finish(std::size_t nth, const PointResult& result) {
    if (options_.progress) options_.progress(nth, 1.0);
    if (options_.on_result) options_.on_result(result);
  }

  bool has_to_stop() {
    if ((options_.stop != nullptr && *options_.stop) || (options_.is_over && options_.is_over())) {
      is_stopped_ = true;
    }
    return is_stopped_;
  }

  const std::vector<std::size_t>& points_;
  const PointSource& source_;
  const StudyFolder& folder_;
  const std::string origin_ = folder_.origin();
  Shard& shard_;
  const ExecutorOptions& options_;
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace

void run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                  const StudyFolder& folder, Shard& shard, const ExecutorOptions& options) {
  allow_many_files();
  const std::size_t jobs = options.threads > 0 ? options.threads : usable_cores();
  const std::size_t share =
      std::clamp<std::size_t>(points.size() / (8 * jobs), 1, most_points_of_a_child());
  Children children(points, source, folder, shard, options);
  on_all_cores((points.size() + share - 1) / share,
               [&](std::size_t nth) {
                 children.run(nth * share, std::min((nth + 1) * share, points.size()));
               },
               jobs);
}

}  // namespace breakwater
