#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/vectors.hpp"
#include "io/text/plain_text.hpp"

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

// Lines that hold something, one after the other: each is asked for by what it should be.
class FilledLines {
 public:
  FilledLines(const std::filesystem::path& file, std::string_view text) : file_(file), lines_(text) {}

  TextRecord line(std::string_view what) {
    while (lines_.next())
      if (!trim(lines_.line()).empty()) return TextRecord(file_, lines_);
    fail_at(file_, std::max(1, lines_.number()), "expected {}, found the end of the file: cut short?", what);
  }
  Vec3 row(std::string_view what) {
    TextRecord record = line(what);
    const double x = record.number(what), y = record.number(what), z = record.number(what);
    record.expect_end(what);
    return {x, y, z};
  }
  Mat3 matrix(std::string_view what) {
    Mat3 result;
    for (int i = 0; i < 3; ++i) result.row(i) = row(fmt::format("row {} of {}", i + 1, what));
    return result;
  }
  void expect_end(std::string_view last) {
    while (lines_.next())
      if (!trim(lines_.line()).empty())
        fail_at(file_, lines_.number(), "expected nothing after {}, found \"{}\"", last,
                excerpt(lines_.line()));
  }
  std::string place() const { return fmt::format("{}:{}", file_.string(), std::max(1, lines_.number())); }

 private:
  const std::filesystem::path& file_;
  LineReader lines_;
};

}  // namespace hybrid::io
