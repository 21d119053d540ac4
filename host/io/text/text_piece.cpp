#include "io/text/text_piece.hpp"

#include <algorithm>
#include <cstring>

namespace hybrid::io {
namespace {

constexpr std::uint64_t kBeyond_bytes = 4096;  // how far the last line may reach

}  // namespace

void TextPiece::load(const InputFile& file, std::uint64_t begin, std::uint64_t first, std::uint64_t last,
                     std::uint64_t end) {
  start_ = first > begin ? first - 1 : first;  // one byte more tells whether a line starts at `first`
  const std::uint64_t stop = end - last > kBeyond_bytes ? last + kBeyond_bytes : end;
  bytes_.resize(stop - start_);
  file.read(start_, bytes_);
  end_ = bytes_.data() + bytes_.size();
  limit_ = bytes_.data() + (last - start_);
  line_ = bytes_.data();
  reaches_text_end_ = stop == end;
  if (first == begin) return;
  line_ = std::find_if(line_, limit_, ends_line);
  line_ = line_ == limit_ ? limit_ : after_line_end(line_, end_);
}

LineWalk walk_lines(const TextPiece& piece, std::uint64_t most) {
  LineWalk walk{piece.line()};
  const char *end = piece.end(), *limit = piece.limit();
  // Without CR, which few files have, one library call finds a line's end.
  const bool returns =
      walk.at < end && std::memchr(walk.at, '\r', static_cast<std::size_t>(end - walk.at)) != nullptr;
  while (walk.at < limit && walk.rows < most) {
    const char* line_end =
        returns
            ? std::find_if(walk.at, end, ends_line)
            : static_cast<const char*>(std::memchr(walk.at, '\n', static_cast<std::size_t>(end - walk.at)));
    if (line_end == nullptr) line_end = end;
    // A CR that is the last byte in memory may have its LF beyond.
    if (!piece.reaches_text_end() && (line_end == end || (*line_end == '\r' && line_end + 1 == end)))
      return walk;
    const bool blank = std::all_of(walk.at, line_end, [](char c) { return c == ' ' || c == '\t'; });
    walk.at = line_end == end ? end : after_line_end(line_end, end);
    ++walk.lines;
    walk.rows += !blank;
  }
  return walk;
}

}  // namespace hybrid::io
