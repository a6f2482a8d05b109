#include <breakwater/render/frame_farm.h>

#include <fcntl.h>
#include <poll.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

// Frames that a process may draw before the first of them is taken.
constexpr std::size_t kAhead = 4;
constexpr int kPollMs = 200;

// Small enough for one atomic write to a pipe.
struct Answer {
  enum class Kind { ready, drawn, failed };
  Kind kind = Kind::ready;
  std::array<char, 400> text{};  // ready: the name of the renderer; failed: the reason
};
static_assert(sizeof(Answer) <= 512, "POSIX' PIPE_BUF");

// An answer that is lost ends the process: the parent then sees its end.
void say(int answers, Answer::Kind kind, const std::string& words) {
  Answer answer{kind};
  std::snprintf(answer.text.data(), answer.text.size(), "%s", words.c_str());
  ssize_t put = 0;
  do {
    put = write(answers, &answer, sizeof(answer));
  } while (put < 0 && errno == EINTR);
  if (put != sizeof(answer)) _exit(EXIT_FAILURE);
}

// Memory for the frames, shared by the children and the parent. Frame k is drawn by process k mod
// `processes`, into slot k mod (kAhead · processes).
class SharedFrames {
 public:
  SharedFrames(const FrameFarm& farm, std::size_t processes)
      : processes_(processes), frame_bytes_(farm.frame_bytes) {
    data_ = mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (data_ == MAP_FAILED) throw RenderError("video: no memory for the frames");
    for (std::size_t i = 0; i < processes; ++i) sem_init(&free(i), 1, kAhead);
  }
  SharedFrames(const SharedFrames&) = delete;
  SharedFrames& operator=(const SharedFrames&) = delete;
  ~SharedFrames() { munmap(data_, bytes()); }

  std::size_t processes() const { return processes_; }
  // The number of free slots of a process.
  sem_t& free(std::size_t process) const { return static_cast<sem_t*>(data_)[process]; }
  std::uint8_t* slot(std::size_t frame) const {
    return static_cast<std::uint8_t*>(data_) + sizeof(sem_t) * processes_ +
           frame % (kAhead * processes_) * frame_bytes_;
  }

 private:
  std::size_t bytes() const { return (sizeof(sem_t) + kAhead * frame_bytes_) * processes_; }

  std::size_t processes_;
  std::size_t frame_bytes_;
  void* data_;
};

[[noreturn]] void work(std::size_t number, int answers, const FrameFarm& farm,
                       const SharedFrames& shared,
                       const std::function<Drawer(std::size_t)>& start) {
  int status = EXIT_FAILURE;
  try {
    // One thread is enough: there is a process for each core.
    setenv("LP_NUM_THREADS", "0", 1);
    const Drawer drawer = start(number);
    say(answers, Answer::Kind::ready, drawer.renderer);
    for (std::size_t frame = number; frame < farm.frames; frame += shared.processes()) {
      while (sem_wait(&shared.free(number)) != 0) continue;  // a signal came
      drawer.draw(frame, shared.slot(frame));
      say(answers, Answer::Kind::drawn, "");
    }
    status = EXIT_SUCCESS;
  } catch (const std::exception& error) {
    say(answers, Answer::Kind::failed, error.what());
  } catch (...) {
    // The parent sees the status.
  }
  _exit(status);  // do not run the parent's exit handlers
}

struct Child {
  pid_t pid;
  int answers;
};

// The child processes. They end with this object.
class Children {
 public:
  Children(const FrameFarm& farm, const SharedFrames& shared,
           const std::function<Drawer(std::size_t)>& start)
      : farm_(farm) {
    for (std::size_t i = 0; i < shared.processes(); ++i) {
      std::array<int, 2> answers{};
      if (pipe2(answers.data(), O_CLOEXEC) != 0) fail();
      const pid_t parent = getpid();
      const pid_t pid = fork();
      if (pid == 0) {
        // A child ends with its parent, and leaves interruptions to the parent.
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(EXIT_FAILURE);
        std::signal(SIGINT, SIG_IGN);
        std::signal(SIGHUP, SIG_IGN);
        std::signal(SIGTERM, SIG_DFL);
        close(answers[0]);
        work(i, answers[1], farm, shared, start);
      }
      close(answers[1]);
      children_.push_back({pid, answers[0]});
      if (pid < 0) fail();
    }
  }
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() { end(); }

  // The next answer of a child. Throws Stopped, or RenderError if the child failed or died.
  Answer next(std::size_t number) {
    Child& child = children_[number];
    pollfd ready{child.answers, POLLIN, 0};
    do {
      if (farm_.stop != nullptr && *farm_.stop) throw Stopped();
    } while (poll(&ready, 1, kPollMs) <= 0);
    Answer answer;
    ssize_t got = 0;
    do {
      got = read(child.answers, &answer, sizeof(answer));
    } while (got < 0 && errno == EINTR);
    if (got != sizeof(answer)) {
      int status = 0;
      waitpid(child.pid, &status, 0);
      child.pid = -1;
      throw RenderError("video: a process that drew it ended (" +
                        (WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                             : "status " + std::to_string(WEXITSTATUS(status))) +
                        ")");
    }
    if (answer.kind == Answer::Kind::failed) throw RenderError(answer.text.data());
    return answer;
  }

 private:
  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    end();
    throw RenderError("video: no process can be made to draw it (" + reason + ")");
  }

  void end() {
    for (const Child& child : children_) {
      close(child.answers);
      if (child.pid <= 0) continue;
      kill(child.pid, SIGKILL);
      waitpid(child.pid, nullptr, 0);
    }
    children_.clear();
  }

  const FrameFarm& farm_;
  std::vector<Child> children_;
};

}  // namespace

std::string draw_frames(const FrameFarm& farm, const std::function<Drawer(std::size_t)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take) {
  const std::size_t processes =
      std::clamp<std::size_t>(farm.frames, 1, std::max(farm.processes, 1U));
  const SharedFrames shared(farm, processes);
  Children children(farm, shared, start);
  std::string renderer;
  for (std::size_t frame = 0; frame < farm.frames; ++frame) {
    if (farm.progress) {
      farm.progress(static_cast<double>(frame) / static_cast<double>(farm.frames));
    }
    const std::size_t process = frame % processes;
    if (frame < processes) renderer = children.next(process).text.data();
    children.next(process);
    take(shared.slot(frame));
    sem_post(&shared.free(process));
  }
  return renderer;
}

}  // namespace breakwater
