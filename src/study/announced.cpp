#include <breakwater/study/announced.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

namespace breakwater {
namespace {

// One of an MJCF file and all that it has read in.
std::string hash_of(const std::string& file, KnownModels& models) {
  return point_key("", models.of({file}));
}

void tell(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

// The models that were named so far; several threads name them.
struct Named {
  std::mutex mutex;
  std::set<std::string> files;
};

}  // namespace

void add_announced_options(CLI::App& app, Announced& announced) {
  app.add_flag("--announce", announced.is_on)->group("");
  app.add_option("--known", announced.known)->expected(1)->take_all()->group("");
}

std::vector<std::string> announced_words(const std::vector<std::string>& known) {
  std::vector<std::string> words = {"--announce"};
  for (const std::string& one : known) words.insert(words.end(), {"--known", one});
  return words;
}

void announce(const Announced& announced, KnownModels& models, ExecutorOptions& options) {
  for (const std::string& known : announced.known) {
    const std::size_t space = known.find(' ');
    const std::string file = known.substr(space + 1);
    if (hash_of(file, models) == known.substr(0, space)) continue;
    throw std::invalid_argument(file + ": was changed while it ran: start again");
  }
  options.models = &models;
  options.on_begin = [](std::size_t point) { tell(fmt::format("begin {}", point)); };
  options.on_models = [&models,
                       named = std::make_shared<Named>()](const std::vector<std::string>& files) {
    const std::lock_guard lock(named->mutex);
    for (const std::string& file : files) {
      if (!named->files.insert(file).second) continue;
      tell(fmt::format("model {} {}", hash_of(file, models), file));
    }
  };
  options.on_key = [](std::size_t point, const std::string& key) {
    tell(fmt::format("key {} {}", point, key));
  };
  options.on_result = [then = std::move(options.on_result)](const PointResult& result) {
    tell(fmt::format("end {} {}", result.number, name_of(result.status)));
    if (then) then(result);
  };
}

}  // namespace breakwater
