#include <breakwater/shell/progress.h>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>

#include <breakwater/signals/environment.h>

namespace breakwater {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kRedrawInterval(0.1);
constexpr Seconds kLineInterval(30.0);
constexpr Seconds kFirstEstimate(0.5);
constexpr std::size_t kUsualWidth = 80;

std::optional<std::size_t> terminal_width(int file) {
  winsize size{};
  if (isatty(file) == 0 || ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return std::nullopt;
  }
  return size.ws_col;
}

}  // namespace

Progress::Progress(std::string what, std::vector<double> weights, bool quiet)
    : what_(std::move(what)),
      weights_(std::move(weights)),
      done_(weights_.size(), 0.0),
      visible_(!quiet),
      in_place_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
  if (visible_ && in_place_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::size_t job, double fraction_done) {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  done_[job] = fraction_done;
  const Seconds interval = in_place_ ? kRedrawInterval : kLineInterval;
  if (std::chrono::steady_clock::now() - drawn_ >= interval) draw();
}

void Progress::draw() {
  drawn_ = std::chrono::steady_clock::now();
  const double done = std::inner_product(done_.begin(), done_.end(), weights_.begin(), 0.0) /
                      std::accumulate(weights_.begin(), weights_.end(), 0.0);
  const double elapsed_s = Seconds(drawn_ - start_).count();
  std::string line = fmt::format("{}: {:.0f} %", what_, 100.0 * done);
  if (done_.size() > 1) {
    line += fmt::format(", {} of {} runs", std::ranges::count(done_, 1.0), done_.size());
  }
  if (elapsed_s > kFirstEstimate.count() && done > 0.0) {
    line += fmt::format(", {:.0f} s left", elapsed_s * (1.0 - done) / done);
  }
  if (in_place_) {
    // A line that wraps could not be rewritten.
    line = "\r\033[K" + line.substr(0, terminal_width(STDERR_FILENO).value_or(kUsualWidth) - 1);
  } else {
    line += '\n';
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

std::size_t output_width() {
  if (const auto columns = terminal_width(STDOUT_FILENO)) return *columns;
  const auto asked = environment("COLUMNS");
  const unsigned long columns = asked ? std::strtoul(asked->c_str(), nullptr, 10) : 0;
  return columns > 0 ? columns : kUsualWidth;
}

}  // namespace breakwater
