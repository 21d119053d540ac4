#include "io/text/number_rows.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "io/text/decimal.hpp"
#include "io/text/text_cursor.hpp"
#include "io/text/text_piece.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kPiece_bytes = 256 << 10;
constexpr std::uint64_t kLeastPiece_bytes = 4 << 10;
constexpr std::size_t kMostPieces = 64;
constexpr std::size_t kPiecesPerThread = 8;

std::size_t most_pieces() {
  return std::min(kMostPieces, kPiecesPerThread * static_cast<std::size_t>(thread_count()));
}

// Calls load(k, first, last) for the pieces of [from, end), at most `count`, on all threads; how many there
// were.
template <typename Load>
std::size_t for_pieces(std::uint64_t from, std::uint64_t end, std::size_t count, const Load& load,
                       std::uint64_t piece_bytes = kPiece_bytes) {
  const std::uint64_t there = (end - from + piece_bytes - 1) / piece_bytes;
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, there));
  parallel_for(count, [&](std::size_t k) {
    const std::uint64_t first = from + k * piece_bytes;
    load(k, first, std::min(first + piece_bytes, end));
  });
  return count;
}

}  // namespace

PassedRows pass_rows(InputFile& file, TextPlace from, std::uint64_t end, std::uint64_t rows) {
  PassedRows passed{from};
  std::vector<TextPiece> pieces(most_pieces());
  std::vector<LineWalk> walks(pieces.size());
  std::size_t batch = 1;
  while (passed.rows < rows && passed.after.offset < end) {
    const std::uint64_t begin = passed.after.offset;
    const std::size_t count = for_pieces(begin, end, batch, [&](std::size_t k, auto first, auto last) {
      pieces[k].load(file, begin, first, last, end);
      walks[k] = walk_lines(pieces[k], ~std::uint64_t{0});
    });
    batch = std::min(2 * batch, pieces.size());
    for (std::size_t k = 0; k < count && passed.rows < rows; ++k) {
      if (walks[k].rows > rows - passed.rows) walks[k] = walk_lines(pieces[k], rows - passed.rows);
      if (walks[k].lines > 0) passed.after.offset = pieces[k].offset(walks[k].at);
      passed.after.line += walks[k].lines;
      passed.rows += walks[k].rows;
      if (passed.rows == rows || walks[k].at >= pieces[k].limit()) continue;
      // A line too long for its piece.
      TextCursor cursor(file, pieces[k].offset(walks[k].at), passed.after.line);
      cursor.skip_blank_lines();
      if (!cursor.at_end()) {
        cursor.next_line();
        ++passed.rows;
      }
      passed.after = {cursor.offset(), cursor.line()};
      batch = 1;
      break;
    }
    if (passed.after.offset == begin) break;
  }
  return passed;
}

struct NumberRows::Piece {
  TextPiece text;
  std::vector<double> values;
  const char* at = nullptr;  // of the line that ended the parsing
  std::uint64_t lines = 0, rows = 0;
  bool commas = false;

  void parse(std::size_t columns);
};

bool separates(char c) {
  return c == ' ' || c == '\t' || c == ',' || c == ';';
}

// Stops at the limit or at the first line that is not a row of `columns` numbers.
void NumberRows::Piece::parse(std::size_t columns) {
  // A number takes a digit and a separator.
  values.resize(static_cast<std::size_t>(text.end() - text.line()) / 2 + columns + 1);
  at = text.line();
  lines = rows = 0;
  commas = false;
  double* to = values.data();
  const char *end = text.end(), *limit = text.limit();
  while (at < limit) {
    const char* next = at;
    std::size_t found = 0;
    bool comma = false;
    for (;;) {
      for (; next != end && separates(*next); ++next) comma |= *next == ',' || *next == ';';
      if (next == end || ends_line(*next)) break;
      if (found == columns) return;
      next = parse_number(next, end, to[found]);
      if (next == nullptr) return;
      if (next != end && !separates(*next) && !ends_line(*next)) return;
      ++found;
    }
    if (found != columns && (found > 0 || comma)) return;
    if (!text.reaches_text_end() && (next == end || (*next == '\r' && next + 1 == end))) return;
    at = next == end ? end : after_line_end(next, end);
    ++lines;
    if (found == 0) continue;
    ++rows;
    to += columns;
    commas |= comma;
  }
}

NumberRows::NumberRows(const InputFile& file, TextPlace from, std::uint64_t end, std::size_t columns)
    : file_(file),
      place_(from),
      end_(end),
      columns_(columns),
      piece_bytes_(kPiece_bytes),
      pieces_(most_pieces()) {}

NumberRows::~NumberRows() = default;

// The pieces from place() on.
void NumberRows::load() {
  const std::uint64_t begin = place_.offset;
  ready_ = for_pieces(
      begin, end_, batch_,
      [&](std::size_t k, auto first, auto last) {
        pieces_[k].text.load(file_, begin, first, last, end_);
        pieces_[k].parse(columns_);
      },
      piece_bytes_);
  piece_ = 0;
  given_lines_ = given_rows_ = 0;
  if (piece_bytes_ < kPiece_bytes)
    piece_bytes_ = std::min(2 * piece_bytes_, kPiece_bytes);
  else
    batch_ = std::min(2 * batch_, pieces_.size());
}

const std::vector<std::span<const double>>& NumberRows::next(std::uint64_t most) {
  parts_.clear();
  while (parts_.empty() && most > 0 && place_.offset < end_) {
    const std::uint64_t begin = place_.offset;
    if (piece_ == ready_) load();
    while (piece_ < ready_ && most > 0) {
      const Piece& piece = pieces_[piece_];
      const std::uint64_t rows = std::min(piece.rows - given_rows_, most);
      LineWalk walk{piece.at, piece.lines, piece.rows};
      if (given_rows_ + rows < piece.rows) walk = walk_lines(piece.text, given_rows_ + rows);
      if (rows > 0)
        parts_.emplace_back(piece.values.data() + given_rows_ * columns_,
                            static_cast<std::size_t>(rows) * columns_);
      most -= rows;
      commas_seen_ |= piece.commas;
      if (walk.lines > given_lines_) place_.offset = piece.text.offset(walk.at);
      place_.line += walk.lines - given_lines_;
      given_lines_ = walk.lines;
      given_rows_ = walk.rows;
      if (walk.rows < piece.rows) return parts_;
      if (walk.at < piece.text.limit()) {  // no such row follows: its reader takes over
        place_.offset = piece.text.offset(walk.at);
        piece_ = ready_ = 0;
        // The next one may be near: a file of such rows is not to be read anew for each.
        batch_ = 1;
        piece_bytes_ = kLeastPiece_bytes;
        return parts_;
      }
      ++piece_;
      given_lines_ = given_rows_ = 0;
    }
    if (place_.offset == begin) break;
  }
  return parts_;
}

}  // namespace hybrid::io
