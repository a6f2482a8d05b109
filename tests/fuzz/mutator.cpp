// Mutations of text by lines and numbers, beside those of libFuzzer by bytes. The files of most
// targets are lines of keys and values.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr const char* kNumbers[] = {
    "0",  "-1",   "1e308",      "1e-320", "nan", "inf",  "-0.0", "0x10", "1e999",
    "[]", "true", "2147483648", "1.5e-5", "[1]", "\"\"", "{}",   "7",    "18446744073709551616"};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    lines.back() += c;
    if (c == '\n') lines.emplace_back();
  }
  return lines;
}

// Replaces one run of the characters of a number.
void replace_number(std::string& line, std::minstd_rand& random) {
  constexpr const char* kOfNumbers = "0123456789.+-eE";
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_digit = line[i] >= '0' && line[i] <= '9';
    if (is_digit && (i == 0 || std::strchr(kOfNumbers, line[i - 1]) == nullptr))
      begins.push_back(i);
  }
  if (begins.empty()) return;
  const std::size_t begin = begins[random() % begins.size()];
  const std::size_t end = std::min(line.find_first_not_of(kOfNumbers, begin), line.size());
  line.replace(begin, end - begin, kNumbers[random() % std::size(kNumbers)]);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  std::minstd_rand random(seed + 1);
  const auto kind = random() % 8;
  if (size == 0 || kind < 4) return LLVMFuzzerMutate(data, size, most);
  std::vector<std::string> lines = lines_of({reinterpret_cast<const char*>(data), size});
  const std::size_t one = random() % lines.size(), other = random() % lines.size();
  if (kind == 4) {
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(one));
  } else if (kind == 5) {
    const std::string copy = lines[one];
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(other), copy);
  } else if (kind == 6) {
    std::swap(lines[one], lines[other]);
  } else {
    replace_number(lines[one], random);
  }
  std::string text;
  for (const std::string& line : lines) text += line;
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}
