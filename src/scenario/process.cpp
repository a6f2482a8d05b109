#include <breakwater/scenario/process.h>

#include <csignal>

namespace breakwater {
namespace {

std::atomic<bool> signalled = false;
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

}  // namespace

void stop_on_signals(std::initializer_list<int> more) {
  struct sigaction action = {};
  action.sa_handler = [](int) { signalled = true; };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  for (const int signal : more) sigaction(signal, &action, nullptr);
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

int out_of_memory() {
  fmt::print(stderr, "run.duration_s: the log of so long a run does not fit in memory\n");
  return kUsage;
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}: {} (see --help)\n", app.get_name(), one_line(error.what()));
    return kUsage;
  }
  return kSuccess;
}

}  // namespace breakwater
