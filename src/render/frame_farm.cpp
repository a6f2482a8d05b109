#include <breakwater/render/frame_farm.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

// The head of a message of a process; its bytes follow. The first message is the name of the
// renderer. Each other one is a frame, or the reason of a failure.
struct Head {
  bool is_failure;
  std::size_t bytes;
};

// A message that is lost ends the process: the parent then sees its end.
void say(int output, bool is_failure, std::string_view message) {
  const Head head = {is_failure, message.size()};
  for (std::string_view left :
       {std::string_view(reinterpret_cast<const char*>(&head), sizeof head), message}) {
    while (!left.empty()) {
      const ssize_t put = write(output, left.data(), left.size());
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) _exit(EXIT_FAILURE);
      left.remove_prefix(static_cast<std::size_t>(put));
    }
  }
}

// Draws frame `number` and each `processes`-th one behind it. It draws one while the pipe is read.
[[noreturn]] void work(std::size_t number, std::size_t processes, int output, const FrameFarm& farm,
                       const std::function<Drawer(std::size_t)>& start) {
  int status = EXIT_FAILURE;
  try {
    // One thread is enough: there is a process for each core.
    setenv("LP_NUM_THREADS", "0", 1);
    const Drawer drawer = start(number);
    say(output, false, drawer.renderer);
    std::vector<std::uint8_t> picture(farm.frame_bytes);
    for (std::size_t frame = number; frame < farm.frames; frame += processes) {
      drawer.draw(frame, picture.data());
      say(output, false, {reinterpret_cast<const char*>(picture.data()), picture.size()});
    }
    status = EXIT_SUCCESS;
  } catch (const std::exception& error) {
    say(output, true, error.what());
  } catch (...) {
    // The parent sees the status.
  }
  _exit(status);  // do not run the parent's exit handlers
}

struct Child {
  pid_t pid;
  int output;
};

// The child processes. They end with this object.
class Children {
 public:
  Children(const FrameFarm& farm, std::size_t processes,
           const std::function<Drawer(std::size_t)>& start)
      : farm_(farm) {
    for (std::size_t i = 0; i < processes; ++i) {
      std::array<int, 2> ends{};
      if (pipe2(ends.data(), O_CLOEXEC) != 0) fail();
      const pid_t parent = getpid();
      const pid_t pid = fork();
      if (pid == 0) {
        // A child ends with its parent, and leaves interruptions to the parent.
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(EXIT_FAILURE);
        std::signal(SIGINT, SIG_IGN);
        std::signal(SIGHUP, SIG_IGN);
        std::signal(SIGTERM, SIG_DFL);
        close(ends[0]);
        work(i, processes, ends[1], farm, start);
      }
      close(ends[1]);
      children_.push_back({pid, ends[0]});
      if (pid < 0) fail();
    }
  }
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() { end(); }

  // The next message of a child. Throws Stopped, or RenderError if the child failed or died.
  const std::string& next(std::size_t number) {
    Head head{};
    read_from(children_[number], reinterpret_cast<char*>(&head), sizeof head);
    message_.resize(head.bytes);
    read_from(children_[number], message_.data(), head.bytes);
    if (head.is_failure) throw RenderError(message_);
    return message_;
  }

 private:
  void read_from(Child& child, char* to, std::size_t bytes) {
    while (bytes > 0) {
      if (farm_.stop != nullptr && *farm_.stop) throw Stopped();
      const ssize_t got = read(child.output, to, bytes);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) fail_for_end(child);
      to += got;
      bytes -= static_cast<std::size_t>(got);
    }
  }

  [[noreturn]] static void fail_for_end(Child& child) {
    int status = 0;
    waitpid(child.pid, &status, 0);
    child.pid = -1;
    throw RenderError("video: a process that drew it ended (" +
                      (WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                           : "status " + std::to_string(WEXITSTATUS(status))) +
                      ")");
  }

  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    end();
    throw RenderError("video: no process can be made to draw it (" + reason + ")");
  }

  void end() {
    for (const Child& child : children_) {
      close(child.output);
      if (child.pid <= 0) continue;
      kill(child.pid, SIGKILL);
      waitpid(child.pid, nullptr, 0);
    }
    children_.clear();
  }

  const FrameFarm& farm_;
  std::vector<Child> children_;
  std::string message_;
};

}  // namespace

std::string draw_frames(const FrameFarm& farm, const std::function<Drawer(std::size_t)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take) {
  const std::size_t processes =
      std::clamp<std::size_t>(farm.frames, 1, std::max(farm.processes, 1U));
  Children children(farm, processes, start);
  std::string renderer;
  for (std::size_t frame = 0; frame < farm.frames; ++frame) {
    if (farm.progress) {
      farm.progress(static_cast<double>(frame) / static_cast<double>(farm.frames));
    }
    const std::size_t process = frame % processes;
    if (frame < processes) renderer = children.next(process);
    take(reinterpret_cast<const std::uint8_t*>(children.next(process).data()));
  }
  return renderer;
}

}  // namespace breakwater
