#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/scan_builder.hpp"
#include "io/scan_entry.hpp"
#include "io/scan_stream.hpp"

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

// A stream whose samples a ScanBuilder makes, block after block.
class BuiltStream : public ScanStream {
 protected:
  explicit BuiltStream(const ScanEntry& entry) : kept_bytes_(entry.kept_bytes) {
    head_.name = entry.name;
    exact_ = entry.exact;
  }
  // Measures all samples; to be called when the head has its grid and origin, and count and columns are
  // known. Throws what ScanBuilder::finish() throws, and gives its notes.
  std::vector<std::string> take(const std::string& file, bool zero_is_no_return);
  void add_notes(const std::vector<std::string>& notes) {
    head_.notes.insert(head_.notes.end(), notes.begin(), notes.end());
  }
  // Adds samples [first, first + count), colours in bytes.
  virtual void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const = 0;

 private:
  SampleBlock load(std::uint64_t first, std::size_t count) const override;

  std::size_t kept_bytes_;
  mutable std::optional<ScanBuilder> builder_;
};

}  // namespace hybrid::io
