#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/scan_stream.hpp"

namespace hybrid::testing {

// The columns of all samples.
struct Samples {
  std::string points, exact;  // bytes, as NaN are the same here
  std::vector<float> intensity;
  std::vector<std::array<std::uint8_t, 3>> rgb;
  std::vector<std::uint32_t> node;

  void add(const io::SampleBlock& block) {
    points.append(reinterpret_cast<const char*>(block.points.data()), block.points.size_bytes());
    exact.append(reinterpret_cast<const char*>(block.exact.data()), block.exact.size_bytes());
    intensity.insert(intensity.end(), block.intensity.begin(), block.intensity.end());
    rgb.insert(rgb.end(), block.rgb.begin(), block.rgb.end());
    node.insert(node.end(), block.node.begin(), block.node.end());
  }
  bool operator==(const Samples&) const = default;
};

Samples samples_of(const io::ScanStream& scan);

// Every scan of a file, streamed, against the same read at once; returns the last.
std::unique_ptr<io::ScanStream> expect_same(const std::filesystem::path& file, bool streams = true,
                                            bool salvage = false);

}  // namespace hybrid::testing
