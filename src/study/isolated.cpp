#include <breakwater/study/isolated.h>

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>

#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/study/announced.h>
#include <breakwater/study/sweep.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostOfAChild =
    200;  // points: what a new process costs is little beside them

// What is told to a child on its command line, which the system limits.
constexpr std::size_t kMostModels = 1000;

}  // namespace

bool is_crash(int signal) {
  constexpr std::array kCrashes = {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS, SIGTRAP, SIGSYS};
  return std::find(kCrashes.begin(), kCrashes.end(), signal) != kCrashes.end();
}

std::size_t run_isolated(const std::vector<std::size_t>& points, const PointSource& source,
                         const IsolatedCommand& command, const StudyFolder& folder, Shard& shard,
                         const ExecutorOptions& options) {
  const std::size_t jobs = options.threads > 0 ? options.threads : usable_cores();
  const std::size_t share = std::clamp<std::size_t>(points.size() / (8 * jobs), 1, kMostOfAChild);
  const std::size_t shares = (points.size() + share - 1) / share;
  std::atomic<std::size_t> finished = 0;
  std::atomic<bool> is_stopped = false;
  std::mutex models_mutex;
  std::map<std::string, std::string> models;  // that a child has named, and what they were then

  const auto index_of = [&](std::size_t point) {
    return static_cast<std::size_t>(std::lower_bound(points.begin(), points.end(), point) -
                                    points.begin());
  };
  const auto run_share = [&](std::size_t nth) {
    std::size_t next = nth * share;
    const std::size_t end = std::min(next + share, points.size());
    while (next < end && !is_stopped) {
      const std::vector<std::size_t> rest(points.begin() + static_cast<std::ptrdiff_t>(next),
                                          points.begin() + static_cast<std::ptrdiff_t>(end));
      std::vector<std::string> words = {own_program(), command.name,       folder.path().string(),
                                        "--points",    print_points(rest), "--jobs",
                                        "1",           "--quiet"};
      std::vector<std::string> known;
      {
        const std::lock_guard lock(models_mutex);
        for (const auto& [file, hash] : models) known.push_back(hash + " " + file);
      }
      const auto add = [&](const std::vector<std::string>& more) {
        words.insert(words.end(), more.begin(), more.end());
      };
      add(announced_words(known));
      if (command.more) add(command.more(rest));
      ReadProgram child(words);
      bool is_under_way = false;  // points[next]
      std::string key;            // of it, once it is known
      bool was_told = false;
      while (const auto line = child.next()) {
        if (line->starts_with("begin ")) {
          next = index_of(std::stoul(line->substr(6)));
          is_under_way = true;
          key.clear();
        }
        if (line->starts_with("model ")) {
          const std::size_t space = line->find(' ', 6);
          const std::string file = line->substr(space + 1), hash = line->substr(6, space - 6);
          const std::lock_guard lock(models_mutex);
          const bool is_full = models.size() >= kMostModels;
          const auto found = is_full ? models.find(file) : models.emplace(file, hash).first;
          if (found != models.end() && found->second != hash) {
            child.interrupt();
            throw std::invalid_argument(file + ": was changed while it ran: start again");
          }
        }
        if (line->starts_with("key ")) key = line->substr(line->rfind(' ') + 1);
        if (line->starts_with("end ")) {
          is_under_way = false;
          if (options.progress) options.progress(next, 1.0);
          PointResult ended;
          ended.number = points[next];
          const bool is_complete = line->ends_with(" " + name_of(PointStatus::complete));
          ended.status = is_complete ? PointStatus::complete : PointStatus::failed;
          if (options.on_result) options.on_result(ended);
          ++next;
          ++finished;
        }
        const bool stop = is_stopped || (options.stop != nullptr && *options.stop) ||
                          (options.is_over && options.is_over());
        if (stop && !was_told) {
          is_stopped = was_told = true;
          child.interrupt();
        }
      }
      const int status = child.wait();
      // One that was still loading knows of no interruption: it ends by the signal.
      if (options.stop != nullptr && *options.stop) is_stopped = true;
      if (is_stopped) break;
      const std::string reason =
          WIFSIGNALED(status)
              ? fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
              : fmt::format("status {}", WEXITSTATUS(status));
      if (WIFSIGNALED(status) && !is_crash(WTERMSIG(status))) {
        // Nothing is known of the point that it was at: it is left undone.
        if (next == end) break;
        fmt::print(stderr, "{}: point {} is left undone: its process was ended by {}\n",
                   command.name, is_under_way && !key.empty() ? key : std::to_string(points[next]),
                   reason);
        ++next;
      } else if (WIFSIGNALED(status) && is_under_way) {
        PointResult crash;
        crash.number = points[next];
        crash.key = key.empty() ? source.unprepared_key(crash.number) : key;
        crash.status = PointStatus::crashed;
        crash.reason = reason;
        shard.add(crash);
        if (options.on_result) options.on_result(crash);
        ++next;
        ++finished;
      } else if (!WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != 130)) {
        throw std::invalid_argument(  // it has said why
            fmt::format("--isolate: a process of the study ended with {}", reason));
      } else if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        break;
      } else {
        is_stopped = true;
      }
    }
  };
  const auto run_share_or_stop = [&](std::size_t nth) {
    try {
      run_share(nth);
    } catch (...) {
      is_stopped = true;  // the other children too
      throw;
    }
  };
  on_all_cores(shares, run_share_or_stop, jobs);
  return finished;
}

}  // namespace breakwater
