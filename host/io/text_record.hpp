#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "io/plain_text.hpp"

namespace hybrid::io {

// One line of a text of blank-separated fields: takes its words off the front, with errors that name file,
// line and field. File and text must outlive it.
class TextRecord {
 public:
  TextRecord(const std::filesystem::path& file, const LineReader& lines)
      : file_(file), line_(lines.number()), rest_(lines.line()) {}

  std::int64_t integer(std::string_view field) {
    const auto word = take(field);
    const auto value = to_integer(word);
    if (!value) fail_at(file_, line_, "{}: expected a whole number, found \"{}\"", field, excerpt(word));
    return *value;
  }
  double number(std::string_view field) {
    const auto word = take(field);
    const auto value = to_double(word);
    if (!value || !std::isfinite(*value))
      fail_at(file_, line_, "{}: expected a finite number, found \"{}\"", field, excerpt(word));
    return *value;
  }
  std::string_view word(std::string_view field) { return take(field); }
  std::string_view rest() const { return trim(rest_); }
  void expect_end(std::string_view what) const {
    if (!rest().empty())
      fail_at(file_, line_, "expected {} and no more, found \"{}\" after it", what, excerpt(rest()));
  }
  int line() const { return line_; }

 private:
  std::string_view take(std::string_view field) {
    const auto word = take_word(rest_);
    if (word.empty()) fail_at(file_, line_, "expected {}, found the end of the line: cut short?", field);
    return word;
  }

  const std::filesystem::path& file_;
  int line_;
  std::string_view rest_;
};

}  // namespace hybrid::io
