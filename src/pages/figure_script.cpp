#include <breakwater/pages/figure_script.h>

#include <vector>

#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/signals/environment.h>

namespace breakwater {
namespace {

std::vector<std::string> script() {
  return {figure_python(), data_file("scripts/figures.py").string()};
}

}  // namespace

std::string figure_python() {
  return environment("BREAKWATER_PYTHON").value_or("/usr/bin/python3");
}

bool can_draw_figures() {
  std::vector<std::string> words = script();
  words.emplace_back("--check");
  return call_program("figures (python3-matplotlib)", words) == kSuccess;
}

int draw_figure(const std::filesystem::path& page, const std::filesystem::path& file) {
  std::vector<std::string> words = script();
  words.insert(words.end(), {page.string(), "--out", file.string()});
  return call_program("figures", words) == kSuccess ? kSuccess : kLaterOutputFailed;
}

}  // namespace breakwater
