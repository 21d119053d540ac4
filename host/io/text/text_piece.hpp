#pragma once
#include <cstdint>
#include <vector>

#include "io/input_file.hpp"

namespace hybrid::io {

// A piece of a text file: the lines that start in bytes [first, last), of which the last may end beyond.
// Pieces that follow each other hold every line once, so that threads can work on them without knowing of
// each other.
class TextPiece {
 public:
  // `begin` is where the text starts, the start of a line; `end` where it ends.
  void load(const InputFile& file, std::uint64_t begin, std::uint64_t first, std::uint64_t last,
            std::uint64_t end);

  const char* line() const { return line_; }    // the first one
  const char* limit() const { return limit_; }  // lines of this piece start before
  const char* end() const { return end_; }      // of what is in memory
  // A line that reaches end() is all there.
  bool reaches_text_end() const { return reaches_text_end_; }
  std::uint64_t offset(const char* at) const {
    return start_ + static_cast<std::uint64_t>(at - bytes_.data());
  }

 private:
  std::vector<char> bytes_;
  std::uint64_t start_ = 0;  // of bytes_ in the file
  const char *line_ = nullptr, *limit_ = nullptr, *end_ = nullptr;
  bool reaches_text_end_ = false;
};

inline bool ends_line(char c) {
  return c == '\n' || c == '\r';
}

// Behind the LF, CR or CR LF at `at`, which is before `end`.
inline const char* after_line_end(const char* at, const char* end) {
  return at + (*at == '\r' && end - at > 1 && at[1] == '\n' ? 2 : 1);
}

// Lines of the piece from `at` on: how many there are, how many of them hold something, and where the walk
// stopped: at the piece's limit, after `most` lines that hold something, or at a line that is not wholly in
// memory.
struct LineWalk {
  const char* at = nullptr;
  std::uint64_t lines = 0, rows = 0;
};
LineWalk walk_lines(const TextPiece& piece, std::uint64_t most);

}  // namespace hybrid::io
