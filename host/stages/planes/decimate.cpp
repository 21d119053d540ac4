#include "stages/planes/decimate.hpp"

#include <algorithm>

#include "core/parallel_blocks.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_decimate.h"

namespace hybrid::stages {
namespace {

static_assert(FATE_NO_SAMPLE == kNoSample && FATE_DISCARDED == kDiscarded && FATE_BOUNDARY == kBoundary &&
              FATE_NON_PLANAR_SQUARE == kNonPlanarSquare && FATE_SMALL_PLANAR_SQUARE == kSmallPlanarSquare &&
              FATE_OUTLIER == kOutlier && FATE_UNDERSAMPLED_SQUARE == kUndersampledSquare);
static_assert(CLASS_UNDERSAMPLED == kUndersampled && CLASS_NON_PLANAR == kNonPlanar &&
              CLASS_PLANAR_TOO_SMALL == kPlanarTooSmall && CLASS_MEMBER == kSuperclusterMember);
static_assert(MASK_MEASURED == kMeasured);

void check_extents(const RangeImage& image, const PlaneSegmentation& segmentation,
                   const std::vector<std::uint8_t>& boundary) {
  const int n = segmentation.square;
  const bool squares_fit =
      n > 0 && segmentation.square_rows == (image.rows + n - 1) / n &&
      segmentation.square_cols == (image.cols + n - 1) / n &&
      segmentation.square_class.size() == static_cast<std::size_t>(segmentation.square_rows) *
                                              static_cast<std::size_t>(segmentation.square_cols);
  if (squares_fit && segmentation.sample_label.size() == image.count() && boundary.size() == image.count())
    return;
  fail(
      ErrorKind::failed,
      "decimate: an image of {} x {} samples, but {} sample labels, {} boundary flags and {} x {} squares of "
      "side {}",
      image.rows, image.cols, segmentation.sample_label.size(), boundary.size(), segmentation.square_rows,
      segmentation.square_cols, n);
}

}  // namespace

Decimation decimate(device::Queue& queue, const RangeImage& image, const PlaneSegmentation& segmentation,
                    const std::vector<std::uint8_t>& boundary, const DecimateOptions& options) {
  check_extents(image, segmentation, boundary);
  Decimation result;
  result.fate.assign(image.count(), kNoSample);
  const auto square_class = queue.array(segmentation.square_class);
  const auto width = static_cast<std::size_t>(image.cols);
  for (const Tile& tile : make_tiles(image.rows, image.cols, options.tile)) {
    const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                            static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)};
    auto mask = queue.array<std::uint8_t>(rect.rows * rect.cols);
    auto label = queue.array<std::uint32_t>(rect.rows * rect.cols);
    auto flags = queue.array<std::uint8_t>(rect.rows * rect.cols);
    auto fate = queue.array<std::uint8_t>(rect.rows * rect.cols);
    queue.write_rect(mask, image.mask.data(), width, rect);
    queue.write_rect(label, segmentation.sample_label.data(), width, rect);
    queue.write_rect(flags, boundary.data(), width, rect);
    DecimateParams params{};
    params.first_row = static_cast<std::uint32_t>(tile.row);
    params.first_col = static_cast<std::uint32_t>(tile.col);
    params.rows = static_cast<std::uint32_t>(tile.rows);
    params.cols = static_cast<std::uint32_t>(tile.cols);
    params.square = static_cast<std::uint32_t>(segmentation.square);
    params.square_cols = static_cast<std::uint32_t>(segmentation.square_cols);
    params.discard_in_mixed_squares = options.discard_in_mixed_squares ? 1 : 0;
    queue.launch("decimate", queue.kernel("decimate"), device::grid(rect.cols, rect.rows), params, mask,
                 label, flags, square_class, fate);
    queue.read_rect(fate, result.fate.data(), width, rect);
  }
  const auto count = [&](const auto& take) {
    return static_cast<std::int64_t>(
        count_if_parallel(result.fate.size(), [&](std::size_t i) { return take(result.fate[i]); }));
  };
  result.measured = count([](std::uint8_t fate) { return fate != kNoSample; });
  result.discarded = count([](std::uint8_t fate) { return fate == kDiscarded; });
  result.measured += static_cast<std::int64_t>(image.extra.size());
  return result;
}

void keep_unexplained(const std::vector<std::uint8_t>& explained, Decimation& decimation) {
  if (explained.size() != decimation.fate.size())
    fail(ErrorKind::failed, "keep_unexplained: {} flags for {} nodes", explained.size(),
         decimation.fate.size());
  decimation.discarded -= static_cast<std::int64_t>(count_if_parallel(explained.size(), [&](std::size_t i) {
    if (decimation.fate[i] != kDiscarded || explained[i]) return false;
    decimation.fate[i] = kUnexplained;
    return true;
  }));
}

}  // namespace hybrid::stages
