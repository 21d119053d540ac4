#include "io/scan_stream.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/free_memory.hpp"
#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/hash_state.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kPart = SampleFacts::kPart;  // samples that a thread takes
static_assert(ScanStream::kBlock % kPart == 0);

class Hash {
 public:
  Hash() : state_(XXH3_createState()) { XXH3_128bits_reset(state_.get()); }
  template <typename T>
  void add(std::span<const T> values) {
    XXH3_128bits_update(state_.get(), values.data(), values.size_bytes());
  }
  std::array<std::uint64_t, 2> digest() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return {hash.high64, hash.low64};
  }

 private:
  HashState state_;
};

void add_intensity(SampleFacts& facts, float value) {
  facts.whole &= value == std::floor(value);
  if (std::isnan(value)) return;
  facts.least = std::min(facts.least, value);
  facts.greatest = std::max(facts.greatest, value);
  if (!std::isfinite(value)) return;
  facts.least_finite = std::min(facts.least_finite, value);
  facts.greatest_finite = std::max(facts.greatest_finite, value);
}

void add_seen(SampleFacts& facts, const Vec3& point) {
  const double range = point.norm();
  if (!std::isfinite(range) || range == 0) return;
  ++facts.seen;
  facts.least_seen_m = facts.least_seen_m.cwiseMin(point);
  facts.greatest_seen_m = facts.greatest_seen_m.cwiseMax(point);
  facts.least_range_m = std::min(facts.least_range_m, range);
  facts.greatest_range_m = std::max(facts.greatest_range_m, range);
}

void add_nodes(SampleFacts& facts, const Scan& scan, std::span<const std::uint32_t> nodes) {
  SampleFacts::NodeBounds& bounds = facts.nodes.emplace_back();
  const auto cols = static_cast<std::uint32_t>(scan.grid_cols);
  for (const std::uint32_t node : nodes) {
    if (node == Scan::kNoNode) {
      ++facts.beside;
      continue;
    }
    const std::uint32_t row = node / cols, col = node % cols;
    bounds = {std::min(bounds.first_row, row), std::max(bounds.last_row, row),
              std::min(bounds.first_col, col), std::max(bounds.last_col, col)};
  }
}

// Of samples [begin, end) of a block; whether their exact coordinates say more than the points.
bool measure_part(const SampleBlock& block, std::size_t begin, std::size_t end, SampleFacts& facts) {
  bool more = false;
  if (!block.node.empty()) add_nodes(facts, *block.scan, block.node.subspan(begin, end - begin));
  for (std::size_t i = begin; i < end; ++i) {
    const auto& point = block.points[i];
    facts.no_returns += !counts_as_return(point);
    if (!block.intensity.empty()) add_intensity(facts, block.intensity[i]);
    if (!is_return(point)) continue;
    ++facts.returns;
    const Vec3 exact = block.exact_point(i);
    facts.least_m = facts.least_m.cwiseMin(exact);
    facts.greatest_m = facts.greatest_m.cwiseMax(exact);
    add_seen(facts, exact);
    more |= block.scan->origin + Vec3(point[0], point[1], point[2]) != exact;
  }
  return more;
}

void add(SampleFacts& sum, const SampleFacts& part) {
  sum.returns += part.returns;
  sum.no_returns += part.no_returns;
  sum.beside += part.beside;
  sum.least = std::min(sum.least, part.least);
  sum.greatest = std::max(sum.greatest, part.greatest);
  sum.least_finite = std::min(sum.least_finite, part.least_finite);
  sum.greatest_finite = std::max(sum.greatest_finite, part.greatest_finite);
  sum.whole &= part.whole;
  sum.least_m = sum.least_m.cwiseMin(part.least_m);
  sum.greatest_m = sum.greatest_m.cwiseMax(part.greatest_m);
  sum.seen += part.seen;
  sum.least_seen_m = sum.least_seen_m.cwiseMin(part.least_seen_m);
  sum.greatest_seen_m = sum.greatest_seen_m.cwiseMax(part.greatest_seen_m);
  sum.least_range_m = std::min(sum.least_range_m, part.least_range_m);
  sum.greatest_range_m = std::max(sum.greatest_range_m, part.greatest_range_m);
  sum.nodes.insert(sum.nodes.end(), part.nodes.begin(), part.nodes.end());
}

template <typename T>
void append_to(std::vector<T>& values, std::span<const T> more) {
  values.insert(values.end(), more.begin(), more.end());
}

template <typename T>
std::span<const T> part_of(const std::vector<T>& values, std::size_t at, std::size_t count) {
  return values.empty() ? std::span<const T>() : std::span(values).subspan(at, count);
}

}  // namespace

void SampleColumns::append(const SampleBlock& block) {
  append_to(points, block.points);
  append_to(exact, block.exact);
  append_to(intensity, block.intensity);
  append_to(rgb, block.rgb);
  append_to(node, block.node);
}

SampleBlock SampleColumns::block(const Scan& scan, std::uint64_t first, std::size_t at,
                                 std::size_t count) const {
  return {&scan,
          first,
          part_of(points, at, count),
          part_of(exact, at, count),
          part_of(intensity, at, count),
          part_of(rgb, at, count),
          part_of(node, at, count)};
}

SampleBlock ScanStream::read(std::uint64_t first, std::size_t count) const {
  if (first + count > kept_.size()) return load(first, count);
  return kept_.block(head_, first, static_cast<std::size_t>(first), count);
}

void ScanStream::for_each_block(const std::function<bool(const SampleBlock&)>& body) const {
  for (std::uint64_t first = 0; first < count_; first += kBlock) {
    check_interrupted();
    if (!body(read(first, static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, count_ - first))))) return;
  }
}

void ScanStream::reserve(std::size_t samples) {
  kept_.points.reserve(samples);
  if (exact_) kept_.exact.reserve(samples);
  if (intensity_) kept_.intensity.reserve(samples);
  if (colour_) kept_.rgb.reserve(samples);
  if (node_) kept_.node.reserve(samples);
}

void ScanStream::measure(std::size_t kept_bytes) {
  // As a Scan without samples has no columns.
  if (count_ == 0) exact_ = intensity_ = colour_ = node_ = false;
  const std::uint64_t most = std::min<std::uint64_t>(count_, kept_bytes / sample_bytes());
  reserve(static_cast<std::size_t>(most));
  Hash points, exact;
  bool more = false;
  for_each_block([&](const SampleBlock& block) {
    std::vector<SampleFacts> parts((block.size() + kPart - 1) / kPart);
    std::vector<char> more_in(parts.size());
    parallel_for(parts.size(), [&](std::size_t k) {
      more_in[k] = measure_part(block, k * kPart, std::min((k + 1) * kPart, block.size()), parts[k]);
    });
    for (const SampleFacts& part : parts) add(facts_, part);
    more |= std::ranges::find(more_in, char{1}) != more_in.end();
    points.add(block.points);
    if (exact_) exact.add(block.exact);
    if (kept_.size() == block.first && block.first + block.size() <= most) kept_.append(block);
    return true;
  });
  exact_ &= more;
  if (!exact_) free_memory(kept_.exact);
  facts_.hash = exact_ ? exact.digest() : points.digest();
  if (head_.organised() && !node_)
    facts_.beside =
        count_ - static_cast<std::uint64_t>(head_.grid_rows) * static_cast<std::uint64_t>(head_.grid_cols);
}

ScanInMemory::ScanInMemory(Scan scan) {
  kept_ = {std::exchange(scan.points, {}), std::exchange(scan.exact, {}), std::exchange(scan.intensity, {}),
           std::exchange(scan.rgb, {}), std::exchange(scan.node, {})};
  head_ = std::move(scan);
  if (!head_.organised()) free_memory(kept_.node);
  count_ = kept_.size();
  exact_ = !kept_.exact.empty();
  intensity_ = !kept_.intensity.empty();
  colour_ = !kept_.rgb.empty();
  node_ = !kept_.node.empty();
  measure(0);
}

SampleBlock ScanInMemory::load(std::uint64_t first, std::size_t count) const {
  throw std::out_of_range(fmt::format("samples {} to {} of {}", first, first + count, count_));
}

}  // namespace hybrid::io
