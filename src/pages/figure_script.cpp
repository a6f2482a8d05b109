#include <breakwater/pages/figure_script.h>

#include <fmt/format.h>

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
  return call_program("figures (python3-h5py, python3-matplotlib)", words) == kSuccess;
}

int draw_figure(const FigureContent& content, const std::filesystem::path& file) {
  std::vector<std::string> words = script();
  for (const std::filesystem::path& run : content.runs) words.push_back(run.string());
  // The "=" is needed: a label may begin with a dash.
  for (const std::string& label : content.labels) words.push_back("--label=" + label);
  for (const Identity look : content.looks) words.push_back(fmt::format("--look={}", look));
  for (const std::string& signal : content.signals) words.push_back("--signal=" + signal);
  if (content.from_s) words.push_back(fmt::format("--from={}", *content.from_s));
  if (content.to_s) words.push_back(fmt::format("--to={}", *content.to_s));
  words.insert(words.end(), {"--out", file.string()});
  return call_program("figures", words) == kSuccess ? kSuccess : kLaterOutputFailed;
}

}  // namespace breakwater
