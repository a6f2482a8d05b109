#include <breakwater/shell/process.h>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <breakwater/record/interrupted.h>
#include <breakwater/record/track.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

std::atomic<bool> signalled = false;
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_signal(int) {
  signalled = true;
}

// Throws nothing even if standard error cannot be written.
int failed(Status status, const std::string& line) {
  std::fputs((one_line(line) + "\n").c_str(), stderr);
  return status;
}

int caught(const std::string& program, const std::function<int()>& body) {
  try {
    return body();
  } catch (const std::invalid_argument& error) {
    return failed(kUsage, error.what());
  } catch (const OutputError& error) {
    return failed(kUsage, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(kUsage, error.path1().string() + ": " + error.code().message());
  } catch (const LogTooLong& error) {
    return failed(kUsage, error.what());
  } catch (const std::bad_alloc&) {
    return failed(kUsage, program + ": there is not enough memory");
  } catch (const std::length_error&) {
    return failed(kUsage, program + ": there is not enough memory");
  } catch (const Interrupted& stop) {
    return failed(kInterrupted, program + ": " + stop.what());
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0 || std::ferror(stderr) != 0) {
      // guarded() prints the reason.
      const auto* const printing = dynamic_cast<const std::system_error*>(&error);
      errno = printing != nullptr ? printing->code().value() : EIO;
      return kLaterOutputFailed;
    }
    if (dynamic_cast<const std::system_error*>(&error) != nullptr) {
      return failed(kUsage, program + ": " + error.what());
    }
    return failed(
        kDefect,
        program + ": this is a defect of Breakwater, or of a part of your own: " + error.what());
  }
}

std::terminate_handler usual_end = nullptr;

[[noreturn]] void end_without_memory() {
  constexpr std::string_view kText = "there is not enough memory\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText.data(), kText.size());
  _exit(kUsage);
}

// Some functions of libraries, such as CLI11's, may not throw but need memory.
[[noreturn]] void on_terminate() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    // The standard library does not say what it could not throw, such as from directory_iterator.
    if (std::uncaught_exceptions() > 0) end_without_memory();
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (...) {
    usual_end();
  }
  std::abort();
}

// An empty "$VARIABLE" of a script must not pass for an omitted option. An option with an optional
// value may be empty.
void check_none_is_empty(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_expected_min() == 0) continue;
    for (const std::string& value : option->results()) {
      if (value.empty()) throw CLI::ValidationError(option->get_name(), "must not be empty");
    }
  }
}

// The option that the first unknown one was meant to be, as did_you_mean().
std::string meant_option(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const std::string& word : app.remaining()) {
    if (word.starts_with("--")) return did_you_mean(word, names);
  }
  return "";
}

}  // namespace

void stop_on_signals(std::initializer_list<int> more) {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  for (const int signal : more) sigaction(signal, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // not under nohup
}

void say_lack_of_memory() {
  usual_end = std::set_terminate(on_terminate);
}

const std::atomic<bool>& interrupted() {
  return signalled;
}

std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n') {
      line += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      line += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    } else {
      line += c;
    }
  }
  return line;
}

void warn(const std::string& program, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    fmt::print(stderr, "{}: warning: {}\n", program, warning);
  }
}

int guarded(const std::string& program, const std::function<int()>& body) {
  // A file size limit then gives an error, as a full disk does.
  std::signal(SIGXFSZ, SIG_IGN);
  const int status = caught(program, body);
  const int printing = errno;
  const int error = std::fflush(stdout) != 0 ? errno : printing;
  static bool is_said = false;  // guarded() may be nested
  if (std::ferror(stdout) == 0 || std::exchange(is_said, true)) return status;
  failed(kLaterOutputFailed,
         fmt::format("standard output: cannot be written ({})", std::strerror(error)));
  return status == kSuccess ? kLaterOutputFailed : status;
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    check_none_is_empty(app);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
  } catch (const CLI::ExtrasError& error) {
    fmt::print(stderr, "{}: {}{} (see --help)\n", app.get_name(), one_line(error.what()),
               meant_option(app));
    return kUsage;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}: {} (see --help)\n", app.get_name(), one_line(error.what()));
    return kUsage;
  }
  return kSuccess;
}

}  // namespace breakwater
