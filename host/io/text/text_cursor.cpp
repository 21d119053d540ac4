#include "io/text/text_cursor.hpp"

#include <algorithm>
#include <charconv>

#include "core/error.hpp"
#include "io/text/decimal.hpp"

namespace hybrid::io {
namespace {

bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

// Where blanks would do.
bool is_comma(char c) {
  return c == ',' || c == ';';
}

bool is_separator(char c) {
  return c == ' ' || c == '\t' || is_comma(c);
}

}  // namespace

TextCursor::TextCursor(InputFile& file, std::uint64_t start, std::uint64_t line,
                       std::uint64_t longest_line_bytes)
    : input_(file), window_offset_(start), line_(line), longest_line_bytes_(longest_line_bytes) {}

void TextCursor::load_line() {
  window_offset_ = offset();
  std::string_view window;
  std::size_t whole = 0;
  for (std::uint64_t least = 1 << 16; whole == 0; least = 2 * window.size()) {
    window = input_.ahead(window_offset_, least);
    if (window.size() == input_.size() - window_offset_) {
      whole = window.size();
      break;
    }
    // A CR that is the window's last byte may have its LF beyond it.
    whole = window.substr(0, window.size() - 1).find_last_of("\r\n") + 1;
    if (whole == 0 && window.size() >= longest_line_bytes_)
      fail_input(
          "{}: line {}: expected a line of at most {} bytes, found a longer one that begins {}; is this "
          "text?",
          file(), line_, longest_line_bytes_, in_quotes(window));
  }
  begin_ = at_ = window.data();
  end_ = begin_ + window.size();
  whole_lines_end_ = begin_ + whole;
}

void TextCursor::end_line() {
  last_line_end_ = "";
  if (at_ != end_) {
    const bool carriage_return = *at_++ == '\r';
    last_line_end_ = carriage_return ? "\r" : "\n";
    if (carriage_return && at_ != end_ && *at_ == '\n') {
      ++at_;
      last_line_end_ = "\r\n";
    }
  }
  ++line_;
}

std::string_view TextCursor::next_line() {
  need_line();
  const char* start = at_;
  at_ = std::find_if(at_, end_, is_line_end);
  const std::string_view line(start, static_cast<std::size_t>(at_ - start));
  end_line();
  return line;
}

void TextCursor::skip_blank_lines() {
  while (!at_end()) {
    need_line();
    const char* next = std::find_if_not(at_, end_, [](char c) { return c == ' ' || c == '\t'; });
    if (next != end_ && !is_line_end(*next)) return;
    at_ = next;
    if (at_ != end_) end_line();
  }
}

void TextCursor::refuse_decimal_commas() {
  need_line();
  const std::string_view line(at_, static_cast<std::size_t>(std::find_if(at_, end_, is_line_end) - at_));
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t inside = line.npos;  // the first comma between two digits
  bool by_blanks = false;
  for (std::size_t k = 1; k + 1 < line.size(); ++k) {
    const char before = line[k - 1], here = line[k], after = line[k + 1];
    if (here == ',' && is_digit(before) && is_digit(after)) inside = std::min(inside, k);
    by_blanks |= (here == ' ' || here == '\t' || here == ';') && is_digit(before) && !is_separator(after);
  }
  if (!by_blanks || inside == line.npos) return;
  const std::size_t begin = line.find_last_of(" \t;", inside) + 1;
  fail_input(
      "{}: line {}: expected numbers with decimal points, found {} with a comma among numbers that blanks or "
      "semicolons separate; export it with points, or replace the commas",
      file(), line_, in_quotes(line.substr(begin, line.find_first_of(" \t;", inside) - begin)));
}

TextCursor::Next TextCursor::next(double& value) {
  while (at_ != end_ && is_separator(*at_)) commas_seen_ |= is_comma(*at_++);
  if (at_ == end_ || is_line_end(*at_)) {
    end_line();
    return Next::line_end;
  }
  const char* end = parse_number(at_, end_, value);
  if (end == nullptr || !(end == end_ || is_separator(*end) || is_line_end(*end))) return Next::other;
  at_ = end;
  return Next::number;
}

bool TextCursor::next_number(double& value) {
  const Next found = next(value);
  if (found != Next::other) return found == Next::number;
  const char* word_end = std::find_if(at_, end_, [](char c) { return is_separator(c) || is_line_end(c); });
  fail_input("{}: line {}: expected a number, found {}; correct or remove that line, or use --salvage",
             file(), line_, in_quotes({at_, static_cast<std::size_t>(word_end - at_)}));
}

std::size_t TextCursor::read_numbers(std::span<double> values) {
  need_line();
  std::size_t count = 0;
  double value = 0;
  while (next_number(value)) {
    if (count < values.size()) values[count] = value;
    ++count;
  }
  return count;
}

std::optional<std::size_t> TextCursor::try_numbers(std::span<double> values) {
  need_line();
  const char* start = at_;
  std::size_t count = 0;
  double value = 0;
  for (Next found = next(value); found != Next::line_end; found = next(value)) {
    if (found == Next::other) {
      at_ = start;
      return {};
    }
    if (count < values.size()) values[count] = value;
    ++count;
  }
  return count;
}

void TextCursor::read_all_numbers(std::vector<double>& values) {
  need_line();
  values.clear();
  double value = 0;
  while (next_number(value)) values.push_back(value);
}

bool TextCursor::next_line_is_numbers(std::size_t count) {
  double value = 0;
  const auto found = words(next_line());
  return found.size() == count && std::all_of(found.begin(), found.end(),
                                              [&](std::string_view word) { return parse_real(word, value); });
}

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> result;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    result.push_back(line.substr(at, end - at));
    at = end;
  }
  return result;
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 24)) {
    if (c >= ' ' && c <= '~')
      result += c;
    else
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return result + (text.size() > 24 ? "...\"" : "\"");
}

bool parse_whole(std::string_view word, std::uint64_t& value) {
  const auto [next, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc{} && next == word.data() + word.size();
}

bool parse_real(std::string_view word, double& value) {
  return !word.empty() &&
         parse_number(word.data(), word.data() + word.size(), value) == word.data() + word.size();
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

}  // namespace hybrid::io
