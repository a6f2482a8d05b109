#include <breakwater/report/measurements.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include <breakwater/record/output_error.h>

namespace breakwater {
namespace {

struct Line {
  std::string key;
  Measurement measurement;
};

// Nothing, if it is not as add() writes it.
std::optional<Line> parse_line(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto key = json.find("key");
  const auto values = json.find("values");
  if (key == json.end() || !key->is_string()) return std::nullopt;
  if (values == json.end() || !values->is_object()) return std::nullopt;
  Line line;
  line.key = key->get<std::string>();
  for (const auto& [name, value] : values->items()) {
    if (!value.is_number() && !value.is_null()) return std::nullopt;
    // JSON has no NaN.
    line.measurement.values[name] =
        value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  }
  if (const auto failed = json.find("failed"); failed != json.end()) {
    const auto failure = json.find("failure");
    if (!failed->is_boolean() || failure == json.end() || !failure->is_string()) {
      return std::nullopt;
    }
    line.measurement.failed = failed->get<bool>();
    line.measurement.failure = failure->get<std::string>();
  }
  return line;
}

}  // namespace

Measurements::Measurements(const std::filesystem::path& file) : file_(file) {
  read();
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    throw OutputError(
        fmt::format("{}: cannot be written ({})", file_.string(), std::strerror(errno)));
  }
}

void Measurements::read() {
  std::ifstream stream(file_);
  for (std::string text; std::getline(stream, text);) {
    is_torn_ = stream.eof();  // no end of line behind it
    if (is_torn_) break;
    if (const auto line = parse_line(text)) known_[line->key] = line->measurement;
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
  // The line that was torn ends here, so that this one is whole.
  if (!append(is_torn_ ? "\n" + line : line)) {
    throw OutputError(
        fmt::format("{}: cannot be written ({})", file_.string(), std::strerror(errno)));
  }
  known_[key] = measurement;
}

bool Measurements::append(const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(descriptor_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      is_torn_ = is_torn_ || written > 0;
      return false;
    }
    written += static_cast<std::size_t>(count);
  }
  is_torn_ = false;
  return true;
}

std::string fingerprint(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += std::to_string(part.size()) + ":" + part;
  return fmt::format("{:016x}", XXH3_64bits(all.data(), all.size()));
}

}  // namespace breakwater
