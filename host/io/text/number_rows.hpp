#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "io/input_file.hpp"

namespace hybrid::io {

// The start of a line.
struct TextPlace {
  std::uint64_t offset = 0, line = 1;
};

// Passes `rows` lines that hold something (blank ones are passed and not counted), on all threads, without
// looking at what they hold. `rows` of the result is less at the end of the text, which is at byte `end`.
struct PassedRows {
  TextPlace after;
  std::uint64_t rows = 0;
};
PassedRows pass_rows(InputFile& file, TextPlace from, std::uint64_t end, std::uint64_t rows);

// Lines of exactly `columns` numbers each, parsed on all threads: the file is cut into pieces at line ends,
// their rows placed by counting lines. Line ends, separators and blank lines as in TextCursor. Memory: a few
// MiB, whatever the file.
class NumberRows {
 public:
  NumberRows(const InputFile& file, TextPlace from, std::uint64_t end, std::size_t columns);
  ~NumberRows();
  NumberRows(const NumberRows&) = delete;
  NumberRows& operator=(const NumberRows&) = delete;

  // The next rows, at most `most`, in parts that follow each other: row-major, valid until the next call.
  // None where the text ends, and where the next line is not such a row: a TextCursor at place() tells what
  // it is.
  const std::vector<std::span<const double>>& next(std::uint64_t most);
  // Of the line after the rows given.
  TextPlace place() const { return place_; }
  // Goes on behind a line that the caller has read by other means.
  void go_on(TextPlace place) {
    place_ = place;
    piece_ = ready_ = 0;
  }
  bool commas_seen() const { return commas_seen_; }
  std::size_t columns() const { return columns_; }

 private:
  struct Piece;
  void load();

  const InputFile& file_;
  TextPlace place_;
  std::uint64_t end_;
  std::size_t columns_, batch_ = 1;  // pieces of the next batch
  std::uint64_t piece_bytes_;        // of one: small where rows are refused
  std::vector<Piece> pieces_;
  std::size_t piece_ = 0, ready_ = 0;  // those from piece_ to ready_ are parsed and not all given
  std::uint64_t given_lines_ = 0, given_rows_ = 0;  // of the first of these
  std::vector<std::span<const double>> parts_;
  bool commas_seen_ = false;
};

}  // namespace hybrid::io
