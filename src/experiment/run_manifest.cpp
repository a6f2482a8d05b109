#include <breakwater/experiment/run_manifest.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/record/input_file.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>

namespace breakwater {
namespace {

using nlohmann::json;

class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {
    std::ifstream stream = open_input(file_);
    json_ = json::parse(stream, nullptr, false);
    if (!json_.is_object() || !json_.contains("scenario") || !json_.contains("state_hash")) {
      throw std::invalid_argument(file_ + ": is not a run's manifest" + broken_line(file_) +
                                  "; give the folder of a run");
    }
  }

  [[noreturn]] void fail(const char* key, const std::string& reason) const {
    throw std::invalid_argument(file_ + ": " + key + ": " + reason +
                                ": the manifest is damaged; run it again");
  }

  const json* find(const char* key) const {
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }

  const json& at(const char* key) const {
    const json* value = find(key);
    if (value == nullptr) fail(key, "is missing");
    return *value;
  }

  std::string text(const char* key) const {
    const json& value = at(key);
    if (!value.is_string()) fail(key, "must be a text");
    return value.get<std::string>();
  }

  std::string text_or_nothing(const char* key) const {
    return find(key) == nullptr ? "" : text(key);
  }

  double number(const char* key) const {
    const json& value = at(key);
    if (!value.is_number()) fail(key, "must be a number");
    return value.get<double>();
  }

 private:
  std::string file_;
  json json_;
};

}  // namespace

RunManifest read_manifest(const std::filesystem::path& folder) {
  const Reader reader((folder / "manifest.json").string());
  RunManifest manifest;
  manifest.scenario = reader.text("scenario");
  manifest.case_name = reader.text("case");
  const json& seed = reader.at("seed");
  if (!seed.is_number_unsigned()) reader.fail("seed", "must be a whole number");
  manifest.seed = seed.dump();
  manifest.state_hash = reader.text("state_hash");
  const std::string status = reader.text("status");
  manifest.is_unfinished = status == kRunning;
  if (manifest.is_unfinished) {
    manifest.failure = Failure{0.0, "its process ended before the run did", true};
  } else if (status == "failed" || status == "cut") {  // a log that was recovered
    manifest.failure = Failure{reader.number("time_s"), reader.text("reason"), status == "cut"};
  } else if (status != "complete") {
    reader.fail("status", "must be complete, failed or running");
  }
  manifest.program = reader.text_or_nothing("program");
  if (const json* models = reader.find("models")) {
    if (!models->is_object()) reader.fail("models", "must be an object");
    for (const auto& [file, hash] : models->items()) {
      if (!hash.is_string()) reader.fail("models", "must be an object of texts");
      manifest.models[file] = hash.get<std::string>();
    }
  }
  if (const json* absent = reader.find("absent")) {
    if (!absent->is_object()) reader.fail("absent", "must be a table");
    for (const auto& [name, reason] : absent->items()) {
      if (!reason.is_string()) reader.fail("absent", "must have texts");
      manifest.absent.push_back({name, "", reason.get<std::string>()});
    }
  }
  if (const json* warnings = reader.find("warnings")) {
    if (!warnings->is_array()) reader.fail("warnings", "must be a list");
    for (const json& line : *warnings) {
      if (!line.is_string()) reader.fail("warnings", "must have texts");
      manifest.warnings.push_back(line.get<std::string>());
    }
  }
  return manifest;
}

std::string where_the_log_is(const std::filesystem::path& folder) {
  return "its log so far is in " + shell_word(folder.string());
}

std::string broken_line(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  try {
    [[maybe_unused]] const json parsed = json::parse(text);
  } catch (const json::parse_error& error) {
    const std::size_t end = std::min(error.byte, text.size());
    const auto before = text.begin() + static_cast<std::ptrdiff_t>(end == 0 ? 0 : end - 1);
    return fmt::format(" (line {} is no JSON)", 1 + std::count(text.begin(), before, '\n'));
  } catch (const json::exception&) {  // a number out of range
  }
  return "";
}

void note_renderer(const std::filesystem::path& folder, const std::string& state_hash,
                   const std::string& picture, const std::string& renderer) {
  const std::filesystem::path file = folder / "manifest.json";
  std::ifstream stream(file);
  auto manifest = nlohmann::ordered_json::parse(stream, nullptr, false);
  // Another run may have replaced it since.
  if (!manifest.is_object() || !manifest.contains("state_hash")) return;
  if (manifest["state_hash"] != state_hash) return;
  auto& renderers = manifest["renderers"];
  if (!renderers.is_object()) renderers = nlohmann::ordered_json::object();
  renderers[picture] = renderer;
  replace_file(file, manifest.dump(2) + "\n");
}

}  // namespace breakwater
