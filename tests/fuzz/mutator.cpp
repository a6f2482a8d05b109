// Mutations of text by lines and numbers, beside those of libFuzzer by bytes. The files of most
// targets are lines of keys and values.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr const char* kNumbers[] = {
    "0",  "-1",   "1e308",      "1e-320", "nan", "inf",  "-0.0", "0x10", "1e999",
    "[]", "true", "2147483648", "1.5e-5", "[1]", "\"\"", "{}",   "7",    "18446744073709551616"};

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != text.npos; begin = end + 1) {
    lines.push_back(text.substr(begin, end + 1 - begin));
  }
  lines.push_back(text.substr(begin));
  return lines;
}

// The line with another number in the place of one.
std::string with_number(std::string line, std::minstd_rand& random) {
  constexpr const char* kOfNumbers = "0123456789.+-eE";
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_digit = line[i] >= '0' && line[i] <= '9';
    if (is_digit && (i == 0 || std::strchr(kOfNumbers, line[i - 1]) == nullptr))
      begins.push_back(i);
  }
  if (begins.empty()) return line;
  const std::size_t begin = begins[random() % begins.size()];
  const std::size_t end = std::min(line.find_first_not_of(kOfNumbers, begin), line.size());
  return line.replace(begin, end - begin, kNumbers[random() % std::size(kNumbers)]);
}

std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::minstd_rand random(seed + 1);
  const auto kind = random() % 8;
  if (size == 0 || kind < 4) return LLVMFuzzerMutate(data, size, most);
  std::vector<std::string_view> lines = lines_of({reinterpret_cast<const char*>(data), size});
  const std::size_t one = random() % lines.size(), other = random() % lines.size();
  std::string changed;
  if (kind == 4) {
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(one));
  } else if (kind == 5) {
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(other), lines[one]);
  } else if (kind == 6) {
    std::swap(lines[one], lines[other]);
  } else {
    lines[one] = changed = with_number(std::string(lines[one]), random);
  }
  std::string text;
  for (const std::string_view line : lines) text += line;
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}

}  // namespace

// With BREAKWATER_PARSER=LETTER all inputs that are made are for this parser of the target.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  static const char* const parser = std::getenv("BREAKWATER_PARSER");
  const std::size_t length = mutate(data, size, most, seed);
  if (parser != nullptr && length > 0) data[0] = static_cast<std::uint8_t>(parser[0]);
  return length;
}
