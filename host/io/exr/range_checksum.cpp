#include "io/exr/range_checksum.hpp"

#include <fmt/format.h>

namespace hybrid::io {

RangeChecksum::State RangeChecksum::start() {
  State state(XXH3_createState(), XXH3_freeState);
  XXH3_128bits_reset(state.get());
  return state;
}

RangeChecksum::RangeChecksum(int rows, int cols, bool wraps, const std::vector<double>& elevation_rad,
                             const std::vector<double>& azimuth_rad) {
  for (std::size_t channel = 0; channel < kChannels; ++channel) states_.push_back(start());
  const std::array<std::int32_t, 3> shape{rows, cols, wraps ? 1 : 0};
  XXH3_128bits_update(shape_.get(), shape.data(), sizeof shape);
  for (const auto* table : {&elevation_rad, &azimuth_rad})
    XXH3_128bits_update(shape_.get(), table->data(), table->size() * sizeof(double));
}

std::string RangeChecksum::text() const {
  const State all = start();
  const auto add = [&](const State& part) {
    XXH128_canonical_t digest;
    XXH128_canonicalFromHash(&digest, XXH3_128bits_digest(part.get()));
    XXH3_128bits_update(all.get(), &digest, sizeof digest);
  };
  add(shape_);
  for (const State& state : states_) add(state);
  const XXH128_hash_t hash = XXH3_128bits_digest(all.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace hybrid::io
