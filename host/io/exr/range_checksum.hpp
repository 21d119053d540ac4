#pragma once
#include <xxhash.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hybrid::io {

// XXH3-128 over what a range image holds, channel by channel, each fed in rows from the top: a reader that
// has a few rows in memory comes to the same value as a writer that has them all.
class RangeChecksum {
 public:
  enum Channel : std::size_t { range, x, y, z, intensity, mask, source, colour, kChannels };

  RangeChecksum(int rows, int cols, bool wraps, const std::vector<double>& elevation_rad,
                const std::vector<double>& azimuth_rad);

  // The mask as bytes, colours as sRGB bytes.
  template <typename T>
  void add(Channel channel, std::span<const T> values) {
    XXH3_128bits_update(states_[channel].get(), values.data(), values.size_bytes());
  }
  // In hexadecimal digits.
  std::string text() const;

 private:
  using State = std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)>;
  static State start();

  State shape_ = start();
  std::vector<State> states_;
};

}  // namespace hybrid::io
