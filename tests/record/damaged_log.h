// Damaged logs, and the results of reading them.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>

namespace breakwater::testing {

constexpr std::size_t kHead = 16 * 1024;  // HDF5 keeps names, types and sizes here

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// Like the log of a scenario: two time bases, scalars and vectors.
inline void write_small_log(const std::filesystem::path& file, int deflate_level) {
  double x = 0;
  double q[7] = {};
  std::vector<Track> tracks;
  for (const char* name : {"control", "physics"}) {
    std::vector<Signal> signals;
    for (int k = 0; k < 6; ++k) {
      signals.push_back({"force_" + std::to_string(k) + "_N",
                         "N",
                         "the force at the tip, as the sensor "
                         "gives it",
                         {&x, 1}});
      signals.push_back({"q_" + std::to_string(k) + "_rad", "rad", "the joints' angles", q});
    }
    Track track(name, std::move(signals), 100);
    for (int k = 0; k < 100; ++k) {
      x = std::sin(k);
      q[k % 7] = std::exp(-k);
      track.append(0.001 * k);
    }
    tracks.push_back(std::move(track));
  }
  write_hdf5_log(file.string(), tracks, deflate_level);
}

// Damages one to four bytes, with any values or with critical ones.
inline std::string damaged(std::string bytes, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t count = 1 + random() % 4;
  for (std::size_t k = 0; k < count; ++k) {
    char& byte = bytes[random() % std::min(bytes.size(), kHead)];
    const std::array<char, 4> choice = {static_cast<char>(random()), '\xff', '\0',
                                        static_cast<char>(byte ^ (1 << random() % 8))};
    byte = choice[random() % choice.size()];
  }
  return bytes;
}

inline void read_all(const std::filesystem::path& file) {
  const std::vector<LogEntry> entries = list_hdf5_signals(file.string());
  std::set<std::string> names;
  for (const LogEntry& entry : entries) {
    names.insert(entry.group + "/" + entry.name);
    names.insert(entry.group + "/time_s");
  }
  for (const std::string& name : names) read_hdf5_signal(file.string(), name);
}

// Calls body() in a child process with 2 s of processor time and 2 GB. Returns "read", "refused"
// (std::invalid_argument), or how the process ended.
template <typename Body>
std::string outcome(Body&& body) {
  enum { kRead, kRefused, kOther };
  const pid_t child = fork();
  if (child == 0) {
    const rlimit seconds = {2, 2};
    [[maybe_unused]] const rlimit bytes = {2UL << 30, 2UL << 30};
    const rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CPU, &seconds);
#ifndef __SANITIZE_ADDRESS__  // it reserves far more memory, and refuses absurd sizes itself
    setrlimit(RLIMIT_AS, &bytes);
#endif
    setrlimit(RLIMIT_CORE, &no_core);
    try {
      body();
      _exit(kRead);
    } catch (const std::invalid_argument&) {
      _exit(kRefused);
    } catch (...) {
      _exit(kOther);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return strsignal(WTERMSIG(status));
  switch (WEXITSTATUS(status)) {
    case kRead:
      return "read";
    case kRefused:
      return "refused";
    default:
      return "another exception";
  }
}

}  // namespace breakwater::testing
