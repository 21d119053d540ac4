#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::io {

// Consecutive samples of a scan, as Scan has them. A column that the scan does not have is empty.
struct SampleBlock {
  const Scan* scan = nullptr;  // whose origin and steps they have
  std::uint64_t first = 0;     // number of the first one
  std::span<const std::array<float, 3>> points{};
  std::span<const std::array<double, 3>> exact{};
  std::span<const float> intensity{};
  std::span<const std::array<std::uint8_t, 3>> rgb{};
  std::span<const std::uint32_t> node{};

  std::size_t size() const { return points.size(); }
  Vec3 exact_point(std::size_t i) const {
    if (!exact.empty()) return {exact[i][0], exact[i][1], exact[i][2]};
    return scan->origin + Vec3(points[i][0], points[i][1], points[i][2]);
  }
};

// Columns in memory; what the scan does not have stays empty.
struct SampleColumns {
  std::vector<std::array<float, 3>> points{};
  std::vector<std::array<double, 3>> exact{};
  std::vector<float> intensity{};
  std::vector<std::array<std::uint8_t, 3>> rgb{};
  std::vector<std::uint32_t> node{};

  std::size_t size() const { return points.size(); }
  void append(const SampleBlock& block);
  // `count` of them from the one at `at` on, which is sample `first` of this scan.
  SampleBlock block(const Scan& scan, std::uint64_t first, std::size_t at, std::size_t count) const;
};

// What all samples of a scan tell together.
struct SampleFacts {
  std::uint64_t returns = 0;     // samples with a finite point
  std::uint64_t no_returns = 0;  // samples without, or at the scan frame's origin
  std::uint64_t beside = 0;      // samples of an organised scan that have no node
  // Of intensities that are numbers, the greatest below the least where there are none; and of finite ones.
  float least = INFINITY, greatest = -INFINITY, least_finite = INFINITY, greatest_finite = -INFINITY;
  bool whole = true;  // every intensity is a whole number
  Vec3 least_m = Vec3::Constant(INFINITY), greatest_m = Vec3::Constant(-INFINITY);  // of returns, absolute
  // The same of returns that are not at the scan frame's origin, and their ranges from it.
  std::uint64_t seen = 0;
  Vec3 least_seen_m = least_m, greatest_seen_m = greatest_m;
  double least_range_m = INFINITY, greatest_range_m = 0;
  // Rows and columns of the nodes of samples 0 to kPart - 1, kPart to 2 kPart - 1 and so on, where samples
  // have nodes: first > last where none of them has one.
  static constexpr std::size_t kPart = 8192;
  struct NodeBounds {
    std::uint32_t first_row = ~0u, last_row = 0, first_col = ~0u, last_col = 0;
  };
  std::vector<NodeBounds> nodes{};
  // XXH3-128, the high half first, of the points, or of the exact ones where there are some.
  std::array<std::uint64_t, 2> hash{};
};

struct LasSteps;

// A scan whose samples are read from its file in blocks, as often as they are asked for: the first ones stay
// in memory, up to a number of bytes, which does not grow with the file. Or one in memory, in the same way.
class ScanStream {
 public:
  static constexpr std::size_t kBlock = 1 << 17;  // samples that readers of a whole stream ask for at a time

  virtual ~ScanStream() = default;

  const Scan& head() const { return head_; }  // all but the samples
  std::uint64_t count() const { return count_; }
  const SampleFacts& facts() const { return facts_; }
  bool has_exact() const { return exact_; }
  bool has_intensity() const { return intensity_; }
  bool has_colour() const { return colour_; }
  bool has_node() const { return node_; }
  // How many samples lie on the grid: others are further returns of a node, or lie beside a range image;
  // unorganised, all.
  std::uint64_t laid_out() const { return count_ - facts_.beside; }
  std::size_t sample_bytes() const {
    return 12 + (exact_ ? 24 : 0) + (intensity_ ? 4 : 0) + (colour_ ? 3 : 0) + (node_ ? 4 : 0);
  }

  // Samples [first, first + count), valid until the next call; one caller at a time. Quick where `first` is
  // where the call before ended.
  SampleBlock read(std::uint64_t first, std::size_t count) const;

  // How a LAS file gives the coordinates (las_steps.hpp): found in passes over all samples, once.
  const LasSteps& las_steps() const;

  // All of them in order: body(block), until one returns false.
  void for_each_block(const std::function<bool(const SampleBlock&)>& body) const;

 protected:
  // The same as read(), from the file.
  virtual SampleBlock load(std::uint64_t first, std::size_t count) const = 0;
  // One pass over all samples: facts(), and has_exact() false where the points hold the same. Keeps the first
  // ones in memory.
  void measure(std::size_t kept_bytes);

  Scan head_;
  std::uint64_t count_ = 0;
  bool exact_ = false, intensity_ = false, colour_ = false, node_ = false;
  SampleColumns kept_;  // samples 0, 1 ...

 private:
  void reserve(std::size_t samples);

  SampleFacts facts_;
  mutable std::shared_ptr<const LasSteps> las_steps_;
};

class ScanInMemory : public ScanStream {
 public:
  explicit ScanInMemory(Scan scan);

 private:
  SampleBlock load(std::uint64_t first, std::size_t count) const override;
};

// A finite point.
inline bool is_return(const std::array<float, 3>& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}
// The same, and not at the mirror.
inline bool counts_as_return(const std::array<float, 3>& point) {
  return is_return(point) && (point[0] != 0 || point[1] != 0 || point[2] != 0);
}

}  // namespace hybrid::io
