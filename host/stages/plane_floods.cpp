#include "stages/plane_floods.hpp"

#include <algorithm>
#include <cmath>

#include "shared/params_window_planes.h"
#include "stages/sample_marks.hpp"
#include "stages/sparse_seeds.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFloodSigmas = 3;
constexpr double kLeastCosine = 0.02;  // as window_planes' seeds
constexpr int kSparseReach = 2;        // samples
constexpr std::uint32_t kInside = 0xffffffffu;

// The samples of an image, by their index.
class WholeField {
 public:
  WholeField(const RangeImage& image, const std::vector<std::uint8_t>& use) : image_(image), use_(use) {
    marks().clear();
  }
  Vec3 point(std::uint32_t i) const { return image_.point(i); }
  double range(const Vec3& point, std::uint32_t) const { return point.norm(); }
  std::uint32_t& mark(std::uint32_t i) { return marks().of(i); }
  template <typename Visit>
  bool for_free_neighbours(std::uint32_t i, int reach, const Visit& visit) const {
    const int cols = image_.cols, row = static_cast<int>(i) / cols, col = static_cast<int>(i) % cols;
    for (int r = std::max(row - reach, 0); r <= std::min(row + reach, image_.rows - 1); ++r)
      for (int step = -reach; step <= reach; ++step) {
        int c = col + step;
        if (image_.wraps) c = (c + cols) % cols;
        if (c < 0 || c >= cols) continue;
        const auto other = static_cast<std::uint32_t>(image_.index(r, c));
        if (use_[other] == kFree && !visit(other)) return false;
      }
    return true;
  }

 private:
  static SampleMarks& marks() {
    thread_local SampleMarks marks;
    return marks;
  }
  const RangeImage& image_;
  const std::vector<std::uint8_t>& use_;
};

// Grows `samples` over what lies on the plane through all of them; empty when they fix none.
template <typename Field>
std::vector<std::uint32_t> flood(Field& field, const RangeNoise& noise, int reach,
                                 std::vector<std::uint32_t> samples) {
  // kInside, or the number of the fit that rejected the sample: the same fit need not be asked again.
  for (const std::uint32_t i : samples) field.mark(i) = kInside;
  if (samples.empty()) return {};
  RayPlane plane(field.point(samples[0]));
  for (const std::uint32_t i : samples) plane.add(field.point(i));
  if (!plane.solve()) return {};

  const auto lies_on = [&](const Vec3& point, double range) {
    const auto [residual, cosine] = plane.at(point, range);
    // The plane's own uncertainty is looked at only where it could matter.
    if (!(cosine >= kLeastCosine)) return false;
    const double limit = kFloodSigmas * noise.at(range, cosine);
    return std::abs(residual) <= limit ||
           std::abs(residual) <= limit * std::sqrt(1 + plane.prediction_variance(point));
  };
  std::size_t fitted = plane.samples();
  std::uint32_t fit = 1;
  for (std::size_t next = 0; next < samples.size(); ++next) {
    const bool fits = field.for_free_neighbours(samples[next], reach, [&](std::uint32_t i) {
      std::uint32_t& mark = field.mark(i);
      if (mark == kInside || mark == fit) return true;
      const Vec3 point = field.point(i);
      mark = lies_on(point, field.range(point, i)) ? kInside : fit;
      if (mark != kInside) return true;
      samples.push_back(i);
      plane.add(point);
      // A refit per tenth of growth: the plane is always known to where it is tested.
      if (10 * plane.samples() < 11 * fitted) return true;
      fitted = plane.samples();
      fit += 1;
      return plane.solve();
    });
    if (!fits) return {};
  }
  // Samples taken while the plane was uncertain leave when all of them contradict it.
  if (!plane.solve()) return {};
  std::erase_if(samples, [&](std::uint32_t i) {
    const Vec3 point = field.point(i);
    const double range = field.range(point, i);
    const auto [residual, cosine] = plane.at(point, range);
    return !(std::abs(residual) <= kFloodSigmas * noise.at(range, cosine)) || !(cosine >= kLeastCosine);
  });
  return samples;
}

std::vector<std::uint32_t> seed_samples(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                        const WindowSeed& seed) {
  if (seed.shape == kSparseSeed) return sparse_seed_samples(image, use, seed);
  const int row = static_cast<int>(seed.sample) / image.cols,
            col = static_cast<int>(seed.sample) % image.cols;
  const std::uint32_t shape = seed.shape;
  std::vector<std::uint32_t> samples;
  for (int r = row; r < row + static_cast<int>(WINDOW_ROWS(shape)); ++r)
    for (int c = col; c < col + static_cast<int>(WINDOW_COLS(shape)); ++c)
      if (const auto i = static_cast<std::uint32_t>(image.index(r, c)); use[i] == kFree) samples.push_back(i);
  return samples;
}

int reach_of(const WindowSeed& seed) {
  return seed.shape == kSparseSeed ? kSparseReach : 1;
}

}  // namespace

PlaneFlood PlaneFlooder::flood(const WindowSeed& seed) const {
  PlaneFlood result;
  WholeField field(image_, use_);
  result.samples = stages::flood(field, noise_, reach_of(seed), seed_samples(image_, use_, seed));
  if (result.samples.empty()) return {};
  std::sort(result.samples.begin(), result.samples.end());
  result.plane = RayPlane(image_.point(result.samples[0]));
  for (const std::uint32_t i : result.samples) result.plane.add(image_.point(i));
  if (!result.plane.solve()) return {};
  for (const std::uint32_t i : result.samples) {
    const Vec3 point = image_.point(i);
    const double range = point.norm();
    const auto [residual, cosine] = result.plane.at(point, range);
    const double sigmas = residual / noise_.at(range, cosine);
    result.chi2 += sigmas * sigmas;
  }
  return result;
}

BlockFloods::BlockFloods(const RangeImage& image, const std::vector<std::uint8_t>& use,
                         const RangeNoise& noise, const Tile& limits)
    : image_(image), use_(use), noise_(noise), limits_(limits), width_(limits.cols + 2 * kSparseReach) {
  nodes_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(limits.rows + 2 * kSparseReach));
  for (int row = limits.row; row < limits.row + limits.rows; ++row)
    for (int col = limits.col; col < limits.col + limits.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (use[i] != kFree) continue;
      const Vec3 point = image.point(i);
      nodes_[local(static_cast<std::uint32_t>(i))] = {image.x[i], image.y[i], image.z[i],
                                                      0,          false,      point.norm()};
    }
}

std::uint32_t BlockFloods::local(std::uint32_t sample) const {
  const int row = static_cast<int>(sample) / image_.cols - limits_.row + kSparseReach,
            col = static_cast<int>(sample) % image_.cols - limits_.col + kSparseReach;
  return static_cast<std::uint32_t>(row * width_ + col);
}

// What flood() asks of a field; the rim of empty nodes spares it asking where the block ends.
struct BlockFloods::Field {
  std::vector<Node>& nodes;
  std::vector<std::uint32_t>& marked;
  int width;

  Vec3 point(std::uint32_t i) const { return {nodes[i].x, nodes[i].y, nodes[i].z}; }
  double range(const Vec3&, std::uint32_t i) const { return nodes[i].range; }
  std::uint32_t& mark(std::uint32_t i) {
    if (nodes[i].mark == 0) marked.push_back(i);
    return nodes[i].mark;
  }
  template <typename Visit>
  bool for_free_neighbours(std::uint32_t i, int reach, const Visit& visit) const {
    for (int down = -reach; down <= reach; ++down)
      for (int right = -reach; right <= reach; ++right) {
        const auto other = static_cast<std::uint32_t>(static_cast<int>(i) + down * width + right);
        if (nodes[other].range > 0 && !visit(other)) return false;
      }
    return true;
  }
};

std::size_t BlockFloods::flood(const WindowSeed& seed, std::size_t least) {
  std::vector<std::uint32_t> start;
  for (const std::uint32_t i : seed_samples(image_, use_, seed)) start.push_back(local(i));
  Field field{nodes_, marked_, width_};
  const auto samples = stages::flood(field, noise_, reach_of(seed), std::move(start));
  for (const std::uint32_t i : marked_) nodes_[i].mark = 0;
  marked_.clear();
  if (samples.size() >= least)
    for (const std::uint32_t i : samples) nodes_[i].covered = true;
  return samples.size();
}

}  // namespace hybrid::stages
