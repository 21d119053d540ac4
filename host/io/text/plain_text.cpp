#include "io/text/plain_text.hpp"

#include <algorithm>
#include <charconv>

#include "io/output.hpp"

namespace hybrid::io {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

bool starts_with_utf16_mark(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
}

template <typename Number>
std::optional<Number> to_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  Number value{};
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

std::string read_plain_text(const std::filesystem::path& file) {
  std::string text = read_text(file);
  if (starts_with_utf16_mark(text))
    fail_at(file, 1, "expected UTF-8 text, found UTF-16; save the file as UTF-8");
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    fail_at(file, static_cast<std::uint64_t>(line),
            "expected text, found a zero byte (byte {}): a binary file, or UTF-16 without its mark; give a "
            "text file "
            "saved as UTF-8",
            zero);
  }
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

bool LineReader::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find_first_of("\r\n");
  terminated_ = end != std::string_view::npos;
  line_ = rest_.substr(0, end);
  ++number_;
  if (!terminated_) {
    rest_ = {};
  } else {
    const bool pair = rest_.substr(end).starts_with("\r\n");
    rest_.remove_prefix(end + (pair ? 2 : 1));
  }
  return true;
}

std::string_view take_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    rest = {};
    return {};
  }
  rest.remove_prefix(begin);
  const std::size_t end = std::min(rest.find_first_of(kBlanks), rest.size());
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end);
  return word;
}

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<double> to_double(std::string_view word) {
  return to_number<double>(word);
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  return to_number<std::int64_t>(word);
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLength = 60;
  std::string result(text.substr(0, kLength));
  // ASCII only: cutting at a byte count may split a UTF-8 sequence, and a terminal must never see raw bytes.
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  if (text.size() > kLength) result += "...";
  return result;
}

}  // namespace hybrid::io
