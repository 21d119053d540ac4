#include "io/text/text_stream.hpp"

#include <algorithm>

#include "io/text/text_samples.hpp"

namespace hybrid::io {

template <typename Builder>
void TextStream::add_next(std::uint64_t count, Builder& builder) const {
  add_text_samples(
      input_, *rows_, count, builder, commas_, [&](const double* row) { return sample(row); },
      [&](TextCursor& cursor, std::span<double> values, std::uint64_t done) {
        read_line(cursor, values, next_ + done);
      });
  next_ += count;
}

void TextStream::seek(std::uint64_t first) const {
  const std::uint64_t place =
      places_.empty() ? 0 : std::min<std::uint64_t>(first / kBlock, places_.size() - 1);
  rows_.emplace(input_, places_.empty() ? lines_.start : places_[place], input_.size(), lines_.columns);
  next_ = place * kBlock;
}

std::vector<std::string> TextStream::take(const Lines& lines) {
  lines_ = lines;
  count_ = lines.count;
  intensity_ = lines.intensity;
  FirstPass first;
  first.zero_is_no_return = lines.zero_is_no_return;
  first.colour = lines.colour;
  for (seek(0); next_ < count_ && !first.done();)
    add_next(std::min<std::uint64_t>(kOriginSamples, count_ - next_), first);
  rows_.reset();
  take_first(first);
  auto notes = BuiltStream::take(input_.name(), lines.zero_is_no_return);
  after_ = rows_ ? rows_->place() : lines.start;
  rows_.reset();
  return notes;
}

void TextStream::add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const {
  if (!rows_ || first != next_) seek(first);
  while (next_ < first) {  // within a block
    add_next(std::min<std::uint64_t>(kBlock, first - next_), builder);
    builder.start_part();
  }
  if (first == places_.size() * kBlock) places_.push_back(rows_->place());
  with_colours(builder, [&](auto& to) { add_next(count, to); });
}

}  // namespace hybrid::io
