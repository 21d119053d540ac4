#include "stages/planes/plane_floods.hpp"

#include <algorithm>
#include <cmath>

#include "shared/params_window_planes.h"
#include "stages/planes/sample_marks.hpp"
#include "stages/planes/sparse_seeds.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFloodSigmas = 3;
constexpr int kSparseReach = kUseReach;     // samples
constexpr double kLeastBody = 0.7;          // of a flood's samples, in what is no tongue of it
constexpr std::uint8_t kEnoughFloods = 16;  // of too few samples each, over one sample

// Marks of samples while one plane floods: 0, one of these, or the number of the fit that rejected the
// sample: the same fit need not be asked again.
constexpr std::uint32_t kInside = 0xffffffffu, kWall = 0xfffffffeu;

// The samples of an image, by their index.
class WholeField {
 public:
  WholeField(const RangeImage& image, const std::vector<std::uint8_t>& use) : image_(image), use_(use) {
    marks().clear();
  }
  FloodSample sample(std::uint32_t i) const { return FloodSample(image_.point(i)); }
  void mark(std::uint32_t i, std::uint32_t value) { marks().of(i) = value; }
  std::uint32_t marked(std::uint32_t i) const { return marks().of(i); }
  template <typename Visit>
  bool for_neighbours(std::uint32_t i, int reach, std::uint32_t fit, const Visit& visit) const {
    const int cols = image_.cols, row = static_cast<int>(i) / cols, col = static_cast<int>(i) % cols;
    for (int r = std::max(row - reach, 0); r <= std::min(row + reach, image_.rows - 1); ++r)
      for (int step = -reach; step <= reach; ++step) {
        const int c = image_.wrapped(col + step);
        if (c < 0 || c >= cols) continue;
        const auto other = static_cast<std::uint32_t>(image_.index(r, c));
        if (use_[other] != kFree) continue;
        const std::uint32_t mark = marks().of(other);
        if (mark != kInside && mark != fit && !visit(other)) return false;
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

// Whether a sample lies on the plane along its ray, seen at no more than grazing incidence: residual and
// incidence of RayPlane::at() against kFloodSigmas of noise, both sides times what would be divided by.
class LiesOn {
 public:
  LiesOn(const RayPlane& plane, const RangeNoise& noise) : plane_(plane), noise_(noise) {}
  // `unsure`: the plane's own uncertainty counts, too.
  bool operator()(const FloodSample& sample, bool unsure) const {
    const double reached = plane_.reached(sample.point);
    const double cosine = std::abs(reached) * plane_.inverse_length() * sample.inverse_range;
    if (!(reached > 0) || !(cosine >= kSeedCosine)) return false;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double sigma_cosine =
        (noise_.base_m + noise_.per_m * sample.range) * cosine +
        (noise_.per_tan_m + noise_.per_m_tan * sample.range) * std::min(sine, RANGE_NOISE_MOST_TAN * cosine);
    const double off = std::abs(sample.range * (reached - 1)) * cosine,
                 limit = kFloodSigmas * sigma_cosine * reached;
    return off <= limit ||
           // Looked at only where it could matter.
           (unsure && off <= limit * std::sqrt(1 + plane_.prediction_variance(sample.point)));
  }

 private:
  const RayPlane& plane_;
  const RangeNoise& noise_;
};

// Grows `samples` over what lies on the plane through all of them; empty when they fix none.
template <typename Field>
std::vector<std::uint32_t> flood(Field& field, const RangeNoise& noise, int reach,
                                 std::vector<std::uint32_t> samples) {
  for (const std::uint32_t i : samples) field.mark(i, kInside);
  if (samples.empty()) return {};
  RayPlane plane(field.sample(samples[0]).point);
  for (const std::uint32_t i : samples) plane.add(field.sample(i).point);
  if (!plane.solve()) return {};

  const LiesOn lies_on(plane, noise);
  std::size_t fitted = plane.samples();
  std::uint32_t fit = 1;
  for (std::size_t next = 0; next < samples.size(); ++next) {
    const bool fits = field.for_neighbours(samples[next], reach, fit, [&](std::uint32_t i) {
      const FloodSample sample = field.sample(i);
      if (!lies_on(sample, true)) {
        field.mark(i, fit);
        return true;
      }
      field.mark(i, kInside);
      samples.push_back(i);
      plane.add(sample.point);
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
  std::erase_if(samples, [&](std::uint32_t i) { return !lies_on(field.sample(i), false); });
  return samples;
}

int reach_of(const WindowSeed& seed) {
  return seed.shape == kSparseSeed ? kSparseReach : 1;
}

}  // namespace

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

PlaneFlood PlaneFlooder::through(std::vector<std::uint32_t> samples) const {
  PlaneFlood result;
  result.samples = std::move(samples);
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

PlaneFlood PlaneFlooder::flood(const WindowSeed& seed) const {
  WholeField field(image_, use_);
  return through(stages::flood(field, noise_, reach_of(seed), seed_samples(image_, use_, seed)));
}

PlaneFlood PlaneFlooder::without_tongues(const PlaneFlood& flood) const {
  // Samples inside, whose four neighbours are the flood's, too, in parts that touch; then what surrounds
  // them.
  constexpr std::uint32_t kOfFlood = 1, kInner = 2, kSeen = 3;
  WholeField field(image_, use_);
  const auto neighbours = [&](std::uint32_t i, const auto& visit) {
    const int cols = image_.cols, row = static_cast<int>(i) / cols, col = static_cast<int>(i) % cols;
    for (int side = 0; side < 4; ++side) {
      const int r = row + (side == 1) - (side == 3);
      int c = col + (side == 0) - (side == 2);
      c = image_.wrapped(c);
      if (r < 0 || r >= image_.rows || c < 0 || c >= cols) continue;
      visit(static_cast<std::uint32_t>(image_.index(r, c)));
    }
  };
  for (const std::uint32_t i : flood.samples) field.mark(i, kOfFlood);
  std::vector<std::uint32_t> inner;
  for (const std::uint32_t i : flood.samples) {
    int held = 0;
    neighbours(i, [&](std::uint32_t other) { held += field.marked(other) != 0; });
    if (held == 4) inner.push_back(i);
  }
  for (const std::uint32_t i : inner) field.mark(i, kInner);
  std::vector<std::uint32_t> largest;
  for (const std::uint32_t start : inner) {
    if (field.marked(start) != kInner) continue;
    std::vector<std::uint32_t> part{start};
    field.mark(start, kSeen);
    for (std::size_t next = 0; next < part.size(); ++next)
      neighbours(part[next], [&](std::uint32_t other) {
        if (field.marked(other) != kInner) return;
        field.mark(other, kSeen);
        part.push_back(other);
      });
    if (part.size() > largest.size()) largest = std::move(part);
  }
  std::vector<std::uint32_t> body = largest;
  for (const std::uint32_t i : largest) {
    field.mark(i, 0);
    neighbours(i, [&](std::uint32_t other) {
      if (field.marked(other) == kOfFlood) {
        field.mark(other, 0);
        body.push_back(other);
      }
    });
  }
  if (static_cast<double>(body.size()) < kLeastBody * static_cast<double>(flood.samples.size())) return {};
  return through(std::move(body));
}

BlockFloods::BlockFloods(const RangeImage& image, const std::vector<std::uint8_t>& use,
                         const RangeNoise& noise, const Tile& limits)
    : image_(image), use_(use), noise_(noise), limits_(limits), width_(limits.cols + 2 * kSparseReach) {
  samples_.resize(static_cast<std::size_t>(width_) *
                  static_cast<std::size_t>(limits.rows + 2 * kSparseReach));
  marks_.assign(samples_.size(), kWall);
  covered_.resize(samples_.size());
  for (int row = limits.row; row < limits.row + limits.rows; ++row)
    for (int col = limits.col; col < limits.col + limits.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (use[i] != kFree) continue;
      const std::uint32_t at = local(static_cast<std::uint32_t>(i));
      samples_[at] = FloodSample(image.point(i));
      marks_[at] = 0;
    }
}

std::uint32_t BlockFloods::local(std::uint32_t sample) const {
  const int row = static_cast<int>(sample) / image_.cols - limits_.row + kSparseReach,
            col = static_cast<int>(sample) % image_.cols - limits_.col + kSparseReach;
  return static_cast<std::uint32_t>(row * width_ + col);
}

bool BlockFloods::is_open(std::uint32_t sample) const {
  return marks_[local(sample)] != kWall && covered_[local(sample)] < kEnoughFloods;
}

// What flood() asks of a field; the rim of walls spares it asking where the block ends.
struct BlockFloods::Field {
  const std::vector<FloodSample>& samples;
  std::vector<std::uint32_t>&marks, &marked;
  int width;

  const FloodSample& sample(std::uint32_t i) const { return samples[i]; }
  void mark(std::uint32_t i, std::uint32_t value) {
    if (marks[i] == 0) marked.push_back(i);
    marks[i] = value;
  }
  template <typename Visit>
  bool for_neighbours(std::uint32_t i, int reach, std::uint32_t fit, const Visit& visit) const {
    for (int down = -reach; down <= reach; ++down)
      for (int right = -reach; right <= reach; ++right) {
        const auto other = static_cast<std::uint32_t>(static_cast<int>(i) + down * width + right);
        const std::uint32_t mark = marks[other];
        if (mark < kWall && mark != fit && !visit(other)) return false;
      }
    return true;
  }
};

std::size_t BlockFloods::flood(const WindowSeed& seed, std::size_t least) {
  std::vector<std::uint32_t> start;
  for (const std::uint32_t i : seed_samples(image_, use_, seed)) start.push_back(local(i));
  Field field{samples_, marks_, marked_, width_};
  const auto samples = stages::flood(field, noise_, reach_of(seed), std::move(start));
  for (const std::uint32_t i : marked_) marks_[i] = 0;
  marked_.clear();
  const bool large = samples.size() >= least;
  for (const std::uint32_t i : samples)
    covered_[i] = large                         ? kEnoughFloods
                  : covered_[i] < kEnoughFloods ? static_cast<std::uint8_t>(covered_[i] + 1)
                                                : covered_[i];
  return samples.size();
}

}  // namespace hybrid::stages
