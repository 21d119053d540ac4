#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/parallel.hpp"
#include "io/scan_builder.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// Takes samples as ScanBuilder does and keeps the first returns, from which origins are chosen.
struct FirstReturns {
  bool zero_is_no_return = false;
  std::vector<std::array<double, 3>> points{};

  bool full() const { return points.size() == kOriginSamples; }
  Vec3 origin() const { return points.empty() ? Vec3(Vec3::Zero()) : local_origin(points); }
  void add(const ScanSample& sample) {
    if (!full() && ScanBuilder::is_place(sample, zero_is_no_return))
      points.push_back({sample.x, sample.y, sample.z});
  }
  void add_lost(std::uint64_t) {}
  template <typename Sample>
  void add_parts(const std::vector<std::size_t>& counts, const Sample& sample) {
    for (std::size_t part = 0; part < counts.size(); ++part)
      for (std::size_t i = 0; i < counts[part] && !full(); ++i) add(sample(part, i));
  }
};

// The same, and the largest colour of all samples, as ScanBuilder keeps it, which tells how colours that are
// no bytes are meant.
struct FirstPass : FirstReturns {
  ColourKind colour = ColourKind::none;
  float largest = 0;

  bool done() const { return full() && colour <= ColourKind::byte; }
  void add(const ScanSample& sample) {
    FirstReturns::add(sample);
    largest = std::max(largest, largest_of(sample));
  }
  template <typename Sample>
  void add_parts(const std::vector<std::size_t>& counts, const Sample& sample) {
    FirstReturns::add_parts(counts, sample);
    if (colour <= ColourKind::byte) return;
    std::vector<float> of_parts(counts.size());
    parallel_for(counts.size(), [&](std::size_t part) {
      for (std::size_t i = 0; i < counts[part]; ++i)
        of_parts[part] = std::max(of_parts[part], largest_of(sample(part, i)));
    });
    for (const float value : of_parts) largest = std::max(largest, value);
  }

 private:
  static float largest_of(const ScanSample& sample) {  // NaN is not
    float result = 0;
    for (const double value : sample.rgb) result = std::max(result, static_cast<float>(value));
    return result;
  }
};

// Passes samples on with their colours as bytes, as ScanBuilder scales them.
struct ScaledColours {
  ScanBuilder& builder;
  double scale;

  ScanSample scaled(ScanSample sample) const {
    for (double& value : sample.rgb) value = scale * static_cast<double>(static_cast<float>(value));
    return sample;
  }
  void add(const ScanSample& sample) { builder.add(scaled(sample)); }
  void add_lost(std::uint64_t count) { builder.add_lost(count); }
  template <typename Sample>
  void add_parts(const std::vector<std::size_t>& counts, const Sample& sample) {
    builder.add_parts(counts, [&](std::size_t part, std::size_t i) { return scaled(sample(part, i)); });
  }
};

// A stream whose samples a ScanBuilder makes, block after block.
class BuiltStream : public ScanStream {
 protected:
  explicit BuiltStream(const ScanEntry& entry) : salvage_(entry.salvage), kept_bytes_(entry.kept_bytes) {
    head_.name = entry.name;
    exact_ = entry.exact;
  }
  // Measures all samples; to be called when the head has its grid and origin, and count and columns are
  // known. Throws what ScanBuilder::finish() throws, and gives its notes.
  std::vector<std::string> take(const std::string& file, bool zero_is_no_return);
  void add_notes(const std::vector<std::string>& notes) {
    head_.notes.insert(head_.notes.end(), notes.begin(), notes.end());
  }
  // What FirstPass found.
  void take_first(const FirstPass& first) {
    head_.origin = first.origin();
    colour_ = first.colour != ColourKind::none;
    if (first.colour > ColourKind::byte)
      colour_scale_ = colour_scale(first.colour, static_cast<double>(first.largest));
  }
  // Calls add(builder) with one that takes the file's colours.
  template <typename Add>
  void with_colours(ScanBuilder& builder, const Add& add_to) const {
    if (!colour_scale_) return add_to(builder);
    ScaledColours scaled{builder, *colour_scale_};
    add_to(scaled);
  }
  // Adds samples [first, first + count), colours in bytes.
  virtual void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const = 0;

 private:
  SampleBlock load(std::uint64_t first, std::size_t count) const override;

  bool salvage_;
  std::size_t kept_bytes_;
  std::optional<double> colour_scale_;
  mutable std::optional<ScanBuilder> builder_;
};

}  // namespace hybrid::io
