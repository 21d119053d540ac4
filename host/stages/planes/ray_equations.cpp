#include "stages/planes/ray_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/cpu_clones.hpp"
#include "core/lanes.hpp"

// The sums of planes' last fits: the most arithmetic the host does of every sample. Plain loops over arrays
// of fixed length, which the compiler turns into the widest vectors of the processor at hand; every processor
// adds in the same order (HYBRID_CPU_CLONES; compiled with options of its own, host/CMakeLists.txt).
namespace hybrid::stages {
namespace {

constexpr double kBiweight = 3.5;     // standard deviations beyond which a sample has no say
constexpr double kBorderBias = 0.15;  // of their noise, by which the samples at a plane's border err alike
constexpr double kLongestStep = 2;
// Of a plane's border: so near to its edge a face that stands on it passes for the plane. More than two
// samples leave too little of narrow planes.
constexpr double kBorder_m = 0.0075, kMostBorder = 2;
constexpr double kMostTangent = RANGE_NOISE_MOST_TAN;

constexpr std::size_t kTerms = RayEquations::kTerms;

// Samples side by side, a lane each; flags are 0 or 1. `near`, `far`: another surface begins 1 or 2 nodes
// away.
struct Samples {
  alignas(64) LaneValues x{}, y{}, z{};
  alignas(64) LaneValues measured{}, near{}, far{};
};

// Where a group of lanes is.
struct Place {
  const std::uint32_t* labels;
  const std::uint8_t* masks;
  std::ptrdiff_t rows, cols, row, col;
  std::size_t count;
  std::uint32_t own;  // label

  // Whether a whole vector from this node on lies within the arrays, of whatever rows.
  bool is_whole(std::ptrdiff_t first) const {
    return first >= 0 && first + static_cast<std::ptrdiff_t>(kVectorLanes) <= rows * cols;
  }
};

// Vectors of the compiler's, for what it makes no vectors of by itself: labels and masks differ in width.
// They are handed on by reference alone: how a function returns one depends on the processor it is compiled
// for.
using Flags =
    std::uint32_t __attribute__((vector_size(kVectorLanes * sizeof(std::uint32_t))));  // all bits or none
using Floats = float __attribute__((vector_size(kVectorLanes * sizeof(float))));
using Longs = std::uint64_t __attribute__((vector_size(kVectorLanes * sizeof(std::uint64_t))));
using Doubles = double __attribute__((vector_size(kVectorLanes * sizeof(double))));

// Lanes beyond `count` hold whatever is there where the arrays go on, else 0: none of them counts.
template <typename Value, typename Lanes>
HYBRID_INLINE void load_some(const Value* from, std::size_t count, bool whole, Lanes& to) {
  if (whole) {
    std::memcpy(&to, from, sizeof to);
    return;
  }
  to = Lanes{};
  std::memcpy(&to, from, count * sizeof *from);
}

HYBRID_INLINE void load_masks(const std::uint8_t* from, std::size_t count, bool whole, Flags& to) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, from, whole ? kVectorLanes : count);
  const Longs spread = (bytes >> Longs{0, 8, 16, 24, 32, 40, 48, 56}) & 255U;
  to = __builtin_convertvector(spread, Flags);
}

template <typename From>
HYBRID_INLINE void widen(const From& from, LaneValues& to) {
  const auto wide = __builtin_convertvector(from, Doubles);
  std::memcpy(&to, &wide, sizeof to);
}

// Whether another surface is `by` nodes from each sample: which of the two a sample there belongs to depends
// on where the planes were thought to be, so that it says little about where they are, and that with a bias.
HYBRID_INLINE void mark_others(const Place& place, std::ptrdiff_t by, Flags& flags) {
  const std::ptrdiff_t first = place.row * place.cols + place.col + by;
  Flags label, mask;
  const bool whole = place.is_whole(first);
  load_some(place.labels + first, place.count, whole, label);
  load_masks(place.masks + first, place.count, whole, mask);
  flags |= (label != place.own) & (mask != std::uint32_t{kEmpty});
}

HYBRID_INLINE void mark_border(const Place& place, std::ptrdiff_t reach, LaneValues& border) {
  Flags flags{};
  if (place.row >= reach) mark_others(place, -reach * place.cols, flags);
  if (place.row + reach < place.rows) mark_others(place, reach * place.cols, flags);
  if (place.col >= reach && place.col + static_cast<std::ptrdiff_t>(place.count) + reach <= place.cols) {
    mark_others(place, -reach, flags);
    mark_others(place, reach, flags);
  } else {
    const std::ptrdiff_t begin = place.row * place.cols;
    for (std::size_t k = 0; k < place.count; ++k) {  // across the seam
      const std::ptrdiff_t col = place.col + static_cast<std::ptrdiff_t>(k);
      for (const std::ptrdiff_t to : {(col + place.cols - reach) % place.cols, (col + reach) % place.cols})
        if (place.labels[begin + to] != place.own && place.masks[begin + to] != kEmpty) flags[k] = ~0U;
    }
  }
  flags &= 1U;
  widen(flags, border);
}

HYBRID_INLINE void load_own(const float* from, std::size_t count, bool whole, const Flags& own,
                            LaneValues& to) {
  Floats values;
  load_some(from, count, whole, values);
  Flags bits;
  std::memcpy(&bits, &values, sizeof bits);
  bits &= own;
  std::memcpy(&values, &bits, sizeof values);
  widen(values, to);
}

// Lanes of nodes that are no samples of the plane's are at the origin, and not measured.
HYBRID_INLINE Samples load(const RangeImage& image, const Place& place) {
  Samples samples;
  const std::ptrdiff_t first = place.row * place.cols + place.col;
  Flags label, mask;
  const bool whole = place.is_whole(first);
  load_some(place.labels + first, place.count, whole, label);
  load_masks(place.masks + first, place.count, whole, mask);
  Flags own = (label == place.own) & (mask == std::uint32_t{kMeasured}) &
              (Flags{0, 1, 2, 3, 4, 5, 6, 7} < static_cast<std::uint32_t>(place.count));
  load_own(image.x.data() + first, place.count, whole, own, samples.x);
  load_own(image.y.data() + first, place.count, whole, own, samples.y);
  load_own(image.z.data() + first, place.count, whole, own, samples.z);
  own &= 1U;
  widen(own, samples.measured);
  mark_border(place, 1, samples.near);
  mark_border(place, 2, samples.far);
  return samples;
}

// What is the same for all samples of a plane.
struct Equation {
  Mat3 axes;
  Vec3 m;
  RangeNoise noise;
  double border_nodes_m;
};

HYBRID_INLINE void add_samples(const Equation& equation, const Samples samples, RayEquations::Lanes& inner,
                               RayEquations::Lanes& border) {
  const Mat3 axes = equation.axes;
  const Vec3 m = equation.m;
  const RangeNoise noise = equation.noise;
  const double border_nodes_m = equation.border_nodes_m;
  alignas(64) std::array<LaneValues, kTerms> terms;
  alignas(64) LaneValues inside, at_border, of_inside, of_border;
  for (std::size_t k = 0; k < kVectorLanes; ++k) {
    const double x = samples.x[k], y = samples.y[k], z = samples.z[k];
    const double range = std::sqrt(x * x + (y * y + z * z));
    const double along = axes(0, 0) * x + (axes(0, 1) * y + axes(0, 2) * z);
    const double r = range * (1 - (m[0] * x + (m[1] * y + m[2] * z)));
    const double cosine = std::abs(along) / range;
    const double tangent =
        std::min(std::sqrt(std::max(1 - cosine * cosine, 0.0)) / std::max(cosine, 1e-6), kMostTangent);
    const double sigma =
        noise.base_m + noise.per_m * range + (noise.per_tan_m + noise.per_m_tan * range) * tangent;
    const double u = r / (kBiweight * sigma), within = 1 - u * u;
    const double weight = within * within / (sigma * sigma), newton = (1 - (5 * u) * u) / within;
    const double measured = samples.measured[k], near = samples.near[k], far = samples.far[k];
    const double counts = within > 0 ? measured : 0.0;  // not of NaN
    // Two nodes away where two are less than the border's width.
    const double beside = border_nodes_m >= (kMostBorder - 0.5) * range ? far : near;
    const double a = range * along, b = range * (axes(1, 0) * x + (axes(1, 1) * y + axes(1, 2) * z)),
                 c = range * (axes(2, 0) * x + (axes(2, 1) * y + axes(2, 2) * z));
    terms[0][k] = a * a;
    terms[1][k] = a * b;
    terms[2][k] = a * c;
    terms[3][k] = b * b;
    terms[4][k] = b * c;
    terms[5][k] = c * c;
    terms[6][k] = a * r;
    terms[7][k] = b * r;
    terms[8][k] = c * r;
    terms[9][k] = 1;
    terms[10][k] = counts > 0 ? newton : 0.0;
    inside[k] = counts * (1 - beside);
    at_border[k] = counts * beside;
    of_inside[k] = inside[k] > 0 ? weight : 0.0;
    of_border[k] = at_border[k] > 0 ? weight : 0.0;
  }
  double any = 0;
  for (std::size_t k = 0; k < kVectorLanes; ++k) {
    inner.samples[k] += inside[k];
    any += at_border[k];
  }
  for (std::size_t t = 0; t < kTerms; ++t)
    for (std::size_t k = 0; k < kVectorLanes; ++k) inner.of[t][k] += of_inside[k] * terms[t][k];
  if (!(any > 0)) return;
  for (std::size_t k = 0; k < kVectorLanes; ++k) border.samples[k] += at_border[k];
  for (std::size_t t = 0; t < kTerms; ++t)
    for (std::size_t k = 0; k < kVectorLanes; ++k) border.of[t][k] += of_border[k] * terms[t][k];
}

}  // namespace

HYBRID_CPU_CLONES
void RayEquations::add_nodes(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                             std::size_t first, std::size_t count, std::uint32_t label, const Frame& frame) {
  if (frame.noise == nullptr) return;
  const Equation equation{frame.axes, frame.m, *frame.noise, kBorder_m / image.step_rad()};
  const auto cols = static_cast<std::size_t>(image.cols);
  Place place{labels.data(),
              image.mask.data(),
              image.rows,
              image.cols,
              static_cast<std::ptrdiff_t>(first / cols),
              static_cast<std::ptrdiff_t>(first % cols),
              0,
              label};
  for (std::size_t done = 0; done < count; done += place.count) {
    place.col += static_cast<std::ptrdiff_t>(place.count);
    place.count = std::min(count - done, kVectorLanes);
    add_samples(equation, load(image, place), inner, border);
  }
}

RayEquations::Sums RayEquations::Lanes::total() const {
  Sums sums;
  for (std::size_t t = 0; t < kTerms; ++t) sums.of[t] = sum_of_lanes(of[t]);
  sums.samples = std::llround(sum_of_lanes(samples));
  return sums;
}

void RayEquations::Sums::add(const Sums& other, double weight) {
  for (std::size_t k = 0; k < of.size(); ++k) of[k] += weight * other.of[k];
  samples += other.samples;
}

double RayEquations::Sums::step() const {
  return of[10] > of[9] / kLongestStep ? std::max(of[9] / of[10], 1.0) : kLongestStep;
}

void RayEquations::merge(const RayEquations& other) {
  for (const auto& [to, from] : {std::pair(&inner, &other.inner), std::pair(&border, &other.border)})
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      for (std::size_t t = 0; t < kTerms; ++t) to->of[t][k] += from->of[t][k];
      to->samples[k] += from->samples[k];
    }
}

// The border's samples err together, by kBorderBias of their noise: however many they are, no more is learned
// from them than from 1 / kBorderBias^2.
RayEquations::Sums RayEquations::weighted(int stride) const {
  Sums all = inner.total();
  const Sums beside = border.total();
  const double count = static_cast<double>(beside.samples) * stride;
  all.add(beside, 1 / (1 + count * kBorderBias * kBorderBias));
  return all;
}

}  // namespace hybrid::stages
