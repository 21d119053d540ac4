#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hybrid::io {

// Reads text from front to back and knows its line: LF, CR/LF, CR and mixtures end a line; a comma separates
// numbers as blanks and tabs do. The text must outlive the cursor.
class TextCursor {
 public:
  // `file` names the text in messages; `line` is the number of its first line.
  TextCursor(std::string file, std::string_view text, std::uint64_t line = 1);

  bool at_end() const { return at_ == end_; }
  // Of the line that next_line or read_numbers returns next, from 1.
  std::uint64_t line() const { return line_; }
  std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  bool commas_seen() const { return commas_seen_; }
  const std::string& file() const { return file_; }

  // The next line without its end.
  std::string_view next_line();
  void skip_blank_lines();

  // The numbers of the next line. Stores the first values.size() of them and returns how many there are.
  // Throws ErrorKind::input naming the line and what is no number.
  std::size_t read_numbers(std::span<double> values);
  void read_all_numbers(std::vector<double>& values);

 private:
  bool next_number(double& value);  // false: the line has ended, and the cursor stands on the next one
  void end_line();

  std::string file_;
  const char* begin_;
  const char* at_;
  const char* end_;
  std::uint64_t line_;
  bool commas_seen_ = false;
};

// Blank-separated words.
std::vector<std::string_view> words(std::string_view line);
// For messages: at most 24 bytes, quoted, everything unprintable as \xNN.
std::string in_quotes(std::string_view text);
// A whole number that is all of `word`; false when it is none or does not fit.
bool parse_whole(std::string_view word, std::uint64_t& value);
bool parse_real(std::string_view word, double& value);
std::string lower_case(std::string_view text);

}  // namespace hybrid::io
