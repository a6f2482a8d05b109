#include <breakwater/report/figure_script.h>

#include <cstdlib>

#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/paths.h>
#include <breakwater/scenario/process.h>

namespace breakwater {
namespace {

// Debian's own Python is the one that has Debian's packages.
std::vector<std::string> script() {
  const char* python = std::getenv("BREAKWATER_PYTHON");
  return {python == nullptr ? "/usr/bin/python3" : python,
          data_file("scripts/figures.py").string()};
}

}  // namespace

bool can_draw_figures() {
  std::vector<std::string> words = script();
  words.emplace_back("--check");
  return call_program("figures (python3-h5py, python3-matplotlib)", words) == kSuccess;
}

int draw_figure(const std::vector<std::filesystem::path>& runs,
                const std::vector<std::string>& signals, const std::filesystem::path& file) {
  std::vector<std::string> words = script();
  for (const std::filesystem::path& run : runs) words.push_back(run.string());
  for (const std::string& signal : signals) words.insert(words.end(), {"--signal", signal});
  words.insert(words.end(), {"--out", file.string()});
  return call_program("figures", words) == kSuccess ? kSuccess : kLaterOutputFailed;
}

}  // namespace breakwater
