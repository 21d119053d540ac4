#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace hybrid::io {

// A text file read whole, without its UTF-8 byte order mark. Throws ErrorKind::input: missing, a folder,
// unreadable, UTF-16 or binary (a zero byte), with the line of the first such byte and the remedy.
std::string read_plain_text(const std::filesystem::path& file);

// Lines of a text one after the other; LF, CR LF and CR end a line. The text must outlive the reader.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  bool next();  // false at the end of the text
  std::string_view line() const { return line_; }
  int number() const { return number_; }           // of line(), from 1
  bool terminated() const { return terminated_; }  // line() had a line end: false for a last line cut short

 private:
  std::string_view rest_, line_;
  int number_ = 0;
  bool terminated_ = true;
};

// Takes the next word (separated by blanks and tabs) off the front of `rest`; "" when there is none.
std::string_view take_word(std::string_view& rest);
std::string_view trim(std::string_view text);

// The whole word as a number, locale-independent; a leading + is allowed. Nothing when any character is left
// over or the value does not fit. "nan" and "inf" are numbers here: callers check std::isfinite.
std::optional<double> to_double(std::string_view word);
std::optional<std::int64_t> to_integer(std::string_view word);

// An excerpt of untrusted text that is safe in a message: at most 60 bytes, everything that is not printable
// ASCII shown as "?".
std::string excerpt(std::string_view text);

// "file:line: message" as ErrorKind::input.
template <typename... Args>
[[noreturn]] void fail_at(const std::filesystem::path& file, std::uint64_t line,
                          fmt::format_string<Args...> format, Args&&... args) {
  fail_input("{}:{}: {}", file.string(), line, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace hybrid::io
