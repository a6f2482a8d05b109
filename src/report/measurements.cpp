#include "report/measurements.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "record/output_error.h"

namespace breakwater {

Measurements::Measurements(const std::filesystem::path& file) : file_(file) {
  bool is_cut_off = false;
  std::ifstream stream(file_);
  for (std::string line; std::getline(stream, line);) {
    is_cut_off = stream.eof();  // no end of line behind it
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (is_cut_off || !json.is_object()) continue;
    Measurement measurement;
    measurement.failed = json.value("failed", false);
    measurement.failure = json.value("failure", "");
    measurement.values = json.value("values", std::map<std::string, double>());
    known_[json.value("key", "")] = measurement;
  }
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    throw OutputError(
        fmt::format("{}: cannot be written ({})", file_.string(), std::strerror(errno)));
  }
  if (is_cut_off && write(descriptor_, "\n", 1) != 1) {
    throw OutputError(file_.string() + ": cannot be written (is the disk full?)");
  }
}

Measurements::~Measurements() {
  close(descriptor_);
}

std::optional<Measurement> Measurements::find(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(key);
  if (found == known_.end()) return std::nullopt;
  return found->second;
}

void Measurements::add(const std::string& key, const std::string& name,
                       const Measurement& measurement) {
  nlohmann::ordered_json json = {{"key", key}, {"run", name}};
  if (measurement.failed) {
    json["failed"] = true;
    json["failure"] = measurement.failure;
  }
  json["values"] = measurement.values;
  const std::string line =
      json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  if (write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    throw OutputError(file_.string() + ": cannot be written (is the disk full?)");
  }
  known_[key] = measurement;
}

std::string fingerprint(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += std::to_string(part.size()) + ":" + part;
  return fmt::format("{:016x}", XXH3_64bits(all.data(), all.size()));
}

}  // namespace breakwater
