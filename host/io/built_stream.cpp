#include "io/built_stream.hpp"

namespace hybrid::io {

std::vector<std::string> BuiltStream::take(const std::string& file, bool zero_is_no_return) {
  const auto make_builder = [&] {
    builder_.emplace(file, head_.name, count_,
                     ScanBuilder::Options{.intensity = intensity_,
                                          .colour = colour_ ? ColourKind::byte : ColourKind::none,
                                          .scaled_colours = colour_scale_.has_value(),
                                          .zero_is_no_return = zero_is_no_return,
                                          .salvage = salvage_,
                                          .exact = exact_,
                                          .origin = head_.origin,
                                          .part = kBlock});
  };
  make_builder();
  measure(kept_bytes_);
  builder_->start_part();
  std::vector<std::string> notes = builder_->finish().notes;
  make_builder();  // exact_ may have changed
  return notes;
}

SampleBlock BuiltStream::load(std::uint64_t first, std::size_t count) const {
  builder_->start_part();
  add(first, count, *builder_);
  const Scan& part = builder_->part();
  return {&head_, first, part.points, part.exact, part.intensity, part.rgb, {}};
}

}  // namespace hybrid::io
