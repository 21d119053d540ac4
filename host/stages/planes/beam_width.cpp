#include "stages/planes/beam_width.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kLargeJump_m = 0.3;  // its mixed samples are within the tolerance of few planes
constexpr double kNearest_m = 0.25;   // where the half octaves begin
constexpr std::size_t kRangeBins = 24;
constexpr std::int64_t kFewestCrossings = 50;  // crossings of a bin
// Wider is no beam: a side of a recess, seen over a few nodes, that is no plane in a scan so coarse.
constexpr BeamWidth kWidest{0.01, 0.003};
constexpr int kSolid = 3;  // samples of each plane beside the gap

struct GapBin {
  std::array<std::int64_t, RimCrossings::kMostGap + 1> crossings{};  // by gap
  double ranges = 0, spacings = 0;                                   // their sums

  void add(const GapBin& other) {
    for (std::size_t k = 0; k < crossings.size(); ++k) crossings[k] += other.crossings[k];
    ranges += other.ranges;
    spacings += other.spacings;
  }
};
using GapBins = std::array<GapBin, kRangeBins>;

// Samples of one label in a row on both sides (the labels of a window's glass and of what is seen through it
// take turns), and none in between that is no mixture of the two, as of a third surface.
bool is_plain(const RangeImage& image, const RimCrossings& crossings,
              const std::vector<std::uint32_t>& labels, int row, int col, int row_step, int col_step,
              const RimCrossing& crossing) {
  const auto at = [&](int k) { return crossings.node(row + k * row_step, col + k * col_step); };
  const auto label = [&](int k) { return at(k) ? labels[*at(k)] : 0; };
  const int beyond = crossing.gap + 1;
  for (int k = 1; k < kSolid; ++k)
    if (label(-k) != label(0) || label(beyond + k) != label(beyond)) return false;
  for (int k = 1; k < beyond; ++k) {
    if (image.mask[*at(k)] != kMeasured) continue;
    const auto here = crossings.behind_m(crossings.plane(*at(0)), *at(k));
    const auto there = crossings.behind_m(crossings.plane(*at(beyond)), *at(k));
    if (!here || !there || !(*here * crossing.jump_m() > 0) || !(*there * crossing.jump_m() < 0))
      return false;
  }
  return true;
}

void count_gaps(const RangeImage& image, const RimCrossings& crossings,
                const std::vector<std::uint32_t>& labels, int row, GapBins& bins) {
  for (int col = 0; col < image.cols; ++col) {
    const std::size_t i = image.index(row, col);
    if (!crossings.on_plane(i) || crossings.is_inside(row, col)) continue;
    for (int row_step = 0; row_step < 2; ++row_step) {
      const int col_step = 1 - row_step;
      const auto crossing = crossings.cross(row, col, row_step, col_step);
      if (!crossing || !crossing->to_plane || !(std::abs(crossing->jump_m()) >= kLargeJump_m) ||
          !is_plain(image, crossings, labels, row, col, row_step, col_step, *crossing))
        continue;
      const std::size_t nearer = crossing->jump_m() > 0 ? i : crossing->beyond;
      const double range = image.point(nearer).norm();
      const double octaves = 2 * std::log2(std::max(range, kNearest_m) / kNearest_m);
      GapBin& bin = bins[std::min(static_cast<std::size_t>(octaves), kRangeBins - 1)];
      bin.crossings[static_cast<std::size_t>(crossing->gap)] += 1;
      bin.ranges += range;
      bin.spacings += crossings.spacing_m(nearer, col_step);
    }
  }
}

// An edge that lies anywhere between the nodes leaves one of two successive numbers of them in the beam's
// reach; other numbers have other causes (samples that did not return, a third surface).
struct MeanGap {
  double nodes = 0, crossings = 0;
};
MeanGap mean_gap(const GapBin& bin) {
  const auto pair = [&](std::size_t k) { return bin.crossings[k] + bin.crossings[k + 1]; };
  std::size_t least = 0;
  for (std::size_t k = 1; k + 1 < bin.crossings.size(); ++k)
    if (pair(k) > pair(least)) least = k;
  const auto count = static_cast<double>(pair(least));
  return {static_cast<double>(least) + static_cast<double>(bin.crossings[least + 1]) / count, count};
}

}  // namespace

BeamWidth measure_beam(const RangeImage& image, const RimCrossings& crossings,
                       const std::vector<std::uint32_t>& labels) {
  std::vector<GapBins> of_row(static_cast<std::size_t>(image.rows));
  parallel_for(of_row.size(), [&](std::size_t row) {
    count_gaps(image, crossings, labels, static_cast<int>(row), of_row[row]);
  });
  // Least squares of the relative errors, which a bin that is far too wide hardly moves.
  double w = 0, wr = 0, wy = 0, wrr = 0, wry = 0;
  for (std::size_t b = 0; b < kRangeBins; ++b) {
    GapBin bin;
    for (const GapBins& row : of_row) bin.add(row[b]);
    std::int64_t all = 0;
    for (const std::int64_t count : bin.crossings) all += count;
    if (all < kFewestCrossings) continue;
    const MeanGap gap = mean_gap(bin);
    const double range = bin.ranges / static_cast<double>(all);
    const double width = gap.nodes * bin.spacings / static_cast<double>(all);
    if (!(width > 0) || width > kWidest.at(range)) continue;
    const double weight = gap.crossings / (width * width);
    w += weight;
    wr += weight * range;
    wy += weight * width;
    wrr += weight * range * range;
    wry += weight * range * width;
  }
  if (!(w > 0)) return {};
  const double det = w * wrr - wr * wr;  // of one bin: 0
  const double per_m = det > 1e-9 * w * wrr ? std::max(0.0, (w * wry - wr * wy) / det) : 0;
  const double base_m = (wy - per_m * wr) / w;
  return base_m > 0 ? BeamWidth{base_m, per_m} : BeamWidth{0, wry / wrr};
}

}  // namespace hybrid::stages
