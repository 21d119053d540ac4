#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/input_file.hpp"

namespace hybrid::io {

inline constexpr std::uint64_t kLongestHeaderLine_bytes = 1 << 20;  // of PCD and PLY

// Reads text from front to back and knows its line: LF, CR/LF, CR and mixtures end a line; a comma separates
// numbers as blanks and tabs do.
class TextCursor {
 public:
  // From byte `start` of a file, whose other readers may move the file's window only once the cursor is not
  // used any more. Lines longer than `longest_line_bytes` are an error, so that binary data taken for text
  // does not fill the memory.
  explicit TextCursor(InputFile& file, std::uint64_t start = 0, std::uint64_t line = 1,
                      std::uint64_t longest_line_bytes = 64 << 20);
  TextCursor(const TextCursor&) = delete;
  TextCursor& operator=(const TextCursor&) = delete;

  bool at_end() const { return offset() == input_.size(); }
  // Of the line that next_line or read_numbers returns next, from 1.
  std::uint64_t line() const { return line_; }
  std::uint64_t offset() const {
    return window_offset_ + static_cast<std::uint64_t>(at_ - begin_);
  }  // in the file
  std::uint64_t remaining() const { return input_.size() - offset(); }
  // Goes to the start of a line that others have found.
  void move_to(std::uint64_t offset, std::uint64_t line) {
    begin_ = at_ = end_ = whole_lines_end_ = nullptr;
    window_offset_ = offset;
    line_ = line;
  }
  bool commas_seen() const { return commas_seen_; }
  const std::string& file() const { return input_.name(); }
  // "\n", "\r", "\r\n" or, at the end of the file, "": what ended the line before this one.
  std::string_view last_line_end() const { return last_line_end_; }

  // The next line without its end; valid until the cursor moves on.
  std::string_view next_line();
  void skip_blank_lines();
  // Throws ErrorKind::input when the next line separates its numbers by blanks and has commas inside them
  // (0,25 1,5): these would be taken for separators, and one number for two.
  void refuse_decimal_commas();

  // The numbers of the next line. Stores the first values.size() of them and returns how many there are.
  // Throws ErrorKind::input naming the line and what is no number.
  std::size_t read_numbers(std::span<double> values);
  void read_all_numbers(std::vector<double>& values);
  // The same as read_numbers(), but nothing, and the line is still the next one, where something in it is no
  // number: for those who look for lines of numbers, as an error costs more than many lines.
  std::optional<std::size_t> try_numbers(std::span<double> values);
  // Whether the next line has exactly `count` words, all numbers. Moves past it.
  bool next_line_is_numbers(std::size_t count);

 private:
  enum class Next { number, line_end, other };
  Next next(double& value);  // line_end: the cursor stands on the next line
  bool next_number(double& value);
  void end_line();
  void need_line() {  // before reading one: all of it is in the window
    if (at_ >= whole_lines_end_) load_line();
  }
  void load_line();

  InputFile& input_;
  std::uint64_t window_offset_;  // of begin_ in the file
  const char* begin_ = nullptr;
  const char* at_ = nullptr;
  const char* end_ = nullptr;
  const char* whole_lines_end_ = nullptr;  // lines that start before here end within the window
  std::uint64_t line_, longest_line_bytes_;
  std::string_view last_line_end_;
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
