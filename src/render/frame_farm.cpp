#include <breakwater/render/frame_farm.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

// Frames that are being drawn or wait for encoding, per process.
constexpr std::size_t kSlotsPerProcess = 4;
// Frames that a process has been given, so that it never waits for the next one.
constexpr std::size_t kOrdersPerProcess = 2;
constexpr int kPollMs = 200;

struct Order {
  std::size_t frame;
  std::size_t slot;
};

// The end of a dead child's answers is enough to notice its death.
class IgnoredSigpipe {
 public:
  IgnoredSigpipe() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
  IgnoredSigpipe(const IgnoredSigpipe&) = delete;
  IgnoredSigpipe& operator=(const IgnoredSigpipe&) = delete;
  ~IgnoredSigpipe() {
    if (before_ != SIG_ERR) std::signal(SIGPIPE, before_);
  }

 private:
  void (*before_)(int);
};

// Small enough for one atomic write to a pipe.
struct Answer {
  enum class Kind { ready, drawn, failed };
  Kind kind;
  std::size_t frame;           // for Kind::drawn
  std::array<char, 400> text;  // ready: the name of the renderer; failed: the reason

  void say(const std::string& words) {
    std::snprintf(text.data(), text.size(), "%s", words.c_str());
  }
};
static_assert(sizeof(Answer) <= 512, "POSIX' PIPE_BUF");

bool read_all(int file, void* data, std::size_t size) {
  ssize_t got = 0;
  do {
    got = read(file, data, size);
  } while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(size);
}

bool write_all(int file, const void* data, std::size_t size) {
  ssize_t put = 0;
  do {
    put = write(file, data, size);
  } while (put < 0 && errno == EINTR);
  return put == static_cast<ssize_t>(size);
}

// Memory for the frames, shared by the children and the parent.
class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes)
      : bytes_(bytes),
        data_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (data_ == MAP_FAILED) throw RenderError("video: no memory for the frames");
  }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  ~SharedMemory() { munmap(data_, bytes_); }

  std::uint8_t* data() const { return static_cast<std::uint8_t*>(data_); }

 private:
  std::size_t bytes_;
  void* data_;
};

struct Child {
  pid_t pid = -1;
  int orders = -1;   // written by the parent
  int answers = -1;  // read by the parent
  std::size_t pending = 0;
};

[[noreturn]] void work(std::size_t number, int orders, int answers, const FrameFarm& farm,
                       std::uint8_t* slots, const std::function<Drawer(std::size_t)>& start) {
  Answer answer{};
  int status = EXIT_SUCCESS;
  try {
    // One thread is enough: there is a process for each core.
    setenv("LP_NUM_THREADS", "0", 1);
    const Drawer drawer = start(number);
    answer.kind = Answer::Kind::ready;
    answer.say(drawer.renderer);
    write_all(answers, &answer, sizeof(answer));
    answer.kind = Answer::Kind::drawn;
    for (Order order{}; read_all(orders, &order, sizeof(order));) {
      drawer.draw(order.frame, slots + order.slot * farm.frame_bytes);
      answer.frame = order.frame;
      if (!write_all(answers, &answer, sizeof(answer))) break;
    }
  } catch (const std::exception& error) {
    answer.kind = Answer::Kind::failed;
    answer.say(error.what());
    write_all(answers, &answer, sizeof(answer));
    status = EXIT_FAILURE;
  } catch (...) {
    status = EXIT_FAILURE;
  }
  _exit(status);  // do not run the parent's exit handlers
}

// The child processes. They end with this object.
class Children {
 public:
  Children(const FrameFarm& farm, std::uint8_t* slots,
           const std::function<Drawer(std::size_t)>& start) {
    const auto count = std::max<std::size_t>(1, std::min<std::size_t>(farm.processes, farm.frames));
    for (std::size_t i = 0; i < count; ++i) {
      std::array<int, 2> orders{};
      std::array<int, 2> answers{};
      if (pipe2(orders.data(), O_CLOEXEC) != 0) fail();
      if (pipe2(answers.data(), O_CLOEXEC) != 0) {
        close(orders[0]);
        close(orders[1]);
        fail();
      }
      const pid_t parent = getpid();
      const pid_t pid = fork();
      if (pid == 0) {
        // A child ends with its parent, and leaves interruptions to the parent.
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(EXIT_FAILURE);
        std::signal(SIGINT, SIG_IGN);
        std::signal(SIGTERM, SIG_DFL);
        for (const Child& sibling : children_) {
          close(sibling.orders);
          close(sibling.answers);
        }
        close(orders[1]);
        close(answers[0]);
        work(i, orders[0], answers[1], farm, slots, start);
      }
      close(orders[0]);
      close(answers[1]);
      children_.push_back({pid, orders[1], answers[0], 0});
      if (pid < 0) fail();
    }
  }
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() { end(); }

  std::vector<Child>& all() { return children_; }

  // The reason of a child's end without an answer.
  static std::string end_of(Child& child) {
    int status = 0;
    waitpid(child.pid, &status, 0);
    child.pid = -1;
    return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                               : "status " + std::to_string(WEXITSTATUS(status));
  }

 private:
  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    end();
    throw RenderError("video: no process can be made to draw it (" + reason + ")");
  }

  void end() {
    for (Child& child : children_) {
      if (child.orders >= 0) close(child.orders);
      if (child.answers >= 0) close(child.answers);
      if (child.pid > 0) {
        kill(child.pid, SIGKILL);
        waitpid(child.pid, nullptr, 0);
      }
    }
    children_.clear();
  }

  std::vector<Child> children_;
};

// Passes the drawn frames on in order, on its own thread.
class Taker {
 public:
  Taker(const FrameFarm& farm, const std::uint8_t* slots, std::size_t slot_count,
        const std::function<void(const std::uint8_t*)>& take)
      : drawn_(farm.frames, false),
        thread_([this, &farm, slots, slot_count, &take](const std::stop_token& stop) {
          for (std::size_t k = 0; k < farm.frames; ++k) {
            {
              std::unique_lock lock(mutex_);
              if (!changed_.wait(lock, stop, [&] { return drawn_[k]; })) return;
            }
            try {
              take(slots + (k % slot_count) * farm.frame_bytes);
            } catch (...) {
              const std::lock_guard lock(mutex_);
              error_ = std::current_exception();
              changed_.notify_all();
              return;
            }
            const std::lock_guard lock(mutex_);
            ++taken_;
            changed_.notify_all();
          }
        }) {}

  void add(std::size_t frame) {
    const std::lock_guard lock(mutex_);
    drawn_[frame] = true;
    changed_.notify_all();
  }

  // The number of frames that were passed on. Throws the exception of `take`.
  std::size_t taken() {
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    return taken_;
  }

  // Waits until more than `count` were passed on, `take` threw, or some time has passed.
  void wait_beyond(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(kPollMs),
                      [&] { return taken_ > count || error_ != nullptr; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<bool> drawn_;
  std::size_t taken_ = 0;
  std::exception_ptr error_;
  std::jthread thread_;  // last, since it uses the members above
};

}  // namespace

std::string draw_frames(const FrameFarm& farm, const std::function<Drawer(std::size_t)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take) {
  const std::size_t slot_count = kSlotsPerProcess * std::max(1U, farm.processes);
  const SharedMemory slots(slot_count * farm.frame_bytes);
  const IgnoredSigpipe no_sigpipe;
  Children children(farm, slots.data(), start);
  std::optional<Taker> taking;
  try {
    taking.emplace(farm, slots.data(), slot_count, take);
  } catch (const std::system_error& error) {
    throw RenderError("video: no thread can be started (" + error.code().message() + ")");
  }
  Taker& taker = *taking;

  std::string renderer;
  std::size_t ordered = 0;
  for (std::size_t taken = 0; taken < farm.frames; taken = taker.taken()) {
    if (farm.stop != nullptr && *farm.stop) throw Stopped();
    if (farm.progress) {
      farm.progress(static_cast<double>(taken) / static_cast<double>(farm.frames));
    }
    std::size_t pending = 0;
    for (std::size_t round = 0; round < kOrdersPerProcess; ++round) {
      for (Child& child : children.all()) {
        const bool has_room = ordered < farm.frames && ordered < taken + slot_count;
        if (!has_room || child.pending > round) continue;
        const Order order{ordered, ordered % slot_count};
        if (!write_all(child.orders, &order, sizeof(order))) continue;  // it has died: see below
        ++child.pending;
        ++ordered;
      }
    }
    std::vector<pollfd> answers;
    for (const Child& child : children.all()) {
      answers.push_back({child.answers, POLLIN, 0});
      pending += child.pending;
    }
    if (pending == 0 && ordered == farm.frames) {
      taker.wait_beyond(taken);  // all frames are drawn; wait for the encoding
      continue;
    }
    if (pending == 0) {
      taker.wait_beyond(taken);  // no slot is free
    }
    if (poll(answers.data(), answers.size(), pending == 0 ? 0 : kPollMs) <= 0) continue;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (answers[i].revents == 0) continue;
      Child& child = children.all()[i];
      Answer answer{};
      if (!read_all(child.answers, &answer, sizeof(answer))) {
        throw RenderError("video: a process that drew it ended (" + Children::end_of(child) + ")");
      }
      if (answer.kind == Answer::Kind::failed) throw RenderError(answer.text.data());
      if (answer.kind == Answer::Kind::ready) {
        renderer = answer.text.data();
        continue;
      }
      --child.pending;
      taker.add(answer.frame);
    }
  }
  return renderer;
}

}  // namespace breakwater
