#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/sim/mjcf_conversion.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using Loss = MjcfChange::Loss;

int convert(const std::string& file, const std::string& folder) {
  ConvertedMjcf converted = convert_mjcf(file, ModelFile::kMostElements);
  const fs::path out = folder;
  const fs::path written = out / fs::path(file).filename();
  std::error_code none;
  if (fs::equivalent(written, file, none)) {
    throw std::invalid_argument(file + ": --out is its own folder, where it would be overwritten");
  }
  Model::load(file);  // says what else the engine refuses, with the place in the user's file
  fs::create_directories(out);
  bring_assets(converted.root, out);
  write_text_file(written.string(), mjcf_text(converted.root));
  bool has_lost = false;
  std::string list;
  for (const auto& [loss, word] : {std::pair(Loss::none, "lossless"),
                                   {Loss::approximated, "approximated"},
                                   {Loss::dropped, "dropped"}}) {
    for (const MjcfChange& change : converted.changes) {
      if (change.loss != loss) continue;
      has_lost |= loss == Loss::dropped;
      list +=
          fmt::format("{:<13} {:>5} x  {}  ({})\n", word, change.count, change.what, change.place);
    }
  }
  if (list.empty()) list = "MuJoCo 2.2 reads the file as it is\n";
  write_text_file((out / "changes.txt").string(), list);
  fmt::print("{}{}: written\n", list, written.string());
  return has_lost ? kRunFailed : kSuccess;
}

}  // namespace

void bring_assets(MjcfElement& root, const fs::path& folder) {
  std::map<std::string, std::string> copies;  // old and new names
  std::set<std::string> taken;
  for_each_section(root, "asset", [&](MjcfElement& assets) {
    for (MjcfElement& asset : assets.children) {
      for (auto& [attribute, value] : asset.attributes) {
        if (!attribute.starts_with("file")) continue;
        auto [copy, is_new] = copies.try_emplace(value);
        if (is_new) {
          const fs::path file = value;
          // The engine names a mesh by its file.
          if (!asset.has("name")) asset.set("name", file.stem().string());
          std::string name = file.filename().string();
          for (int i = 2; !taken.insert(name).second; ++i) {
            name = fmt::format("{}-{}{}", file.stem().string(), i, file.extension().string());
          }
          copy->second = "assets/" + name;
          fs::create_directories(folder / "assets");
          fs::copy_file(file, folder / copy->second, fs::copy_options::overwrite_existing);
        }
        value = copy->second;
      }
    }
  });
}

int convert_main(const Catalogue&, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " convert";
  return guarded(program, [&] {
    CLI::App app("convert a model file of MuJoCo 3 to MuJoCo 2.2, as every run does in memory",
                 program);
    std::string file;
    std::string out;
    app.add_option("FILE", file, "an MJCF file")->required();
    app.add_option("--out", out, "folder for the model, its assets and changes.txt")
        ->required()
        ->type_name("DIR");
    app.footer(
        "The list says what changed, and where first: lossless, approximated, or dropped.\n"
        "Exit status: 0 success, 1 a defect, 2 usage, input or a model that cannot be\n"
        "converted, 3 something was dropped.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return convert(file, out);
  });
}

}  // namespace breakwater
