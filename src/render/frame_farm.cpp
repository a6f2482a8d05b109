#include <breakwater/render/frame_farm.h>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <vector>

#include <breakwater/record/interrupted.h>
#include <breakwater/record/output_error.h>
#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

constexpr useconds_t kBetweenLooks_us = 300;     // a process looks for its turn
constexpr useconds_t kBetweenReports_us = 5000;  // the parent looks for ended ones

// The memory of all processes.
struct Shared {
  std::atomic<std::size_t> taken;  // frames
  bool is_output;                  // whether the failure is one of `take`
  char reason[1000];               // the failure's
  char renderer[400];
};
static_assert(std::atomic<std::size_t>::is_always_lock_free, "used by several processes");

template <std::size_t N>
void say(char (&place)[N], const std::string& text) {
  place[text.copy(place, N - 1)] = '\0';
}

// Draws frame `number` and each `processes`-th one behind it.
[[noreturn]] void work(std::size_t number, const FrameFarm& farm,
                       const std::function<Drawer(std::size_t)>& start,
                       const std::function<void(const std::uint8_t*)>& take, Shared& shared) {
  try {
    // One thread is enough: there is a process for each core.
    setenv("LP_NUM_THREADS", "0", 1);
    const Drawer drawer = start(number);
    if (number == 0) say(shared.renderer, drawer.renderer);
    for (std::size_t frame = number; frame < farm.frames; frame += farm.processes) {
      const std::uint8_t* const picture = drawer.draw(frame);
      while (shared.taken < frame) usleep(kBetweenLooks_us);
      take(picture);
      ++shared.taken;
    }
    _exit(EXIT_SUCCESS);  // do not run the parent's exit handlers
  } catch (const std::exception& error) {
    shared.is_output = dynamic_cast<const OutputError*>(&error) != nullptr;
    say(shared.reason, error.what());
  } catch (...) {
    // The parent sees the status.
  }
  _exit(EXIT_FAILURE);
}

// The child processes, 0 for one that has ended. They end with this object.
struct Children {
  Children() = default;
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() {
    for (const pid_t pid : pids) {
      if (pid == 0) continue;
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }

  std::vector<pid_t> pids;
};

// Throws if a child has failed or died.
bool are_at_work(std::vector<pid_t>& pids, const Shared& shared) {
  for (pid_t& pid : pids) {
    int status = 0;
    if (pid > 0 && waitpid(pid, &status, WNOHANG) == pid) pid = 0;
    if (status == 0) continue;
    if (shared.is_output) throw OutputError(shared.reason);
    if (shared.reason[0] != '\0') throw RenderError(shared.reason);
    throw RenderError(fmt::format("video: a process that drew it ended ({} {})",
                                  WIFSIGNALED(status) ? "signal" : "status",
                                  WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status)));
  }
  return std::any_of(pids.begin(), pids.end(), [](pid_t pid) { return pid > 0; });
}

}  // namespace

std::string draw_frames(const FrameFarm& farm, const std::function<Drawer(std::size_t)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take) {
  FrameFarm used = farm;
  used.processes =
      std::clamp<std::size_t>(farm.frames, 1, std::max<std::size_t>(farm.processes, 1));
  void* const memory =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw RenderError("video: there is no memory for it");
  const auto unmap = [](Shared* shared) { munmap(shared, sizeof(Shared)); };
  const std::unique_ptr<Shared, decltype(unmap)> shared(new (memory) Shared{}, unmap);
  Children children;
  const pid_t parent = getpid();
  for (std::size_t i = 0; i < used.processes; ++i) {
    const pid_t pid = fork();
    if (pid == 0) {
      // A child ends with its parent, and leaves interruptions to the parent.
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(EXIT_FAILURE);
      std::signal(SIGINT, SIG_IGN);
      std::signal(SIGHUP, SIG_IGN);
      std::signal(SIGTERM, SIG_DFL);
      work(i, used, start, take, *shared);
    }
    if (pid < 0) {
      throw RenderError(
          fmt::format("video: no process can be made to draw it ({})", std::strerror(errno)));
    }
    children.pids.push_back(pid);
  }
  while (are_at_work(children.pids, *shared)) {
    if (farm.stop != nullptr && *farm.stop) throw Interrupted();
    if (farm.progress) {
      farm.progress(static_cast<double>(shared->taken) / static_cast<double>(farm.frames));
    }
    usleep(kBetweenReports_us);
  }
  return shared->renderer;
}

}  // namespace breakwater
