#include "score/measure/region_table.hpp"

namespace score {

RegionTable count_overlaps(const JoinedScan& scan, Planes which) {
  std::map<std::uint64_t, std::int64_t> pairs;         // region << 32 | plane
  std::map<std::uint32_t, std::int64_t> out_of_count;  // by region, on planes that do not count
  std::uint64_t last_pair = ~0ull;
  std::int64_t* last = nullptr;  // neighbours mostly fall on one pair
  for (std::size_t i = 0; i < scan.kind.size(); ++i) {
    if (scan.kind[i] == kNotMeasured) continue;
    const bool on_plane = scan.kind[i] == kPlanar && scan.plane[i] != 0;
    if (on_plane && which == Planes::that_count && !scan.counts(i)) {
      ++out_of_count[scan.label[i]];
      continue;
    }
    const std::uint64_t pair =
        (static_cast<std::uint64_t>(scan.label[i]) << 32) | (on_plane ? scan.plane[i] : 0u);
    if (pair != last_pair) {
      last = &pairs[pair];
      last_pair = pair;
    }
    ++*last;
  }
  RegionTable table;
  for (const auto& [pair, samples] : pairs) {
    const auto region = static_cast<std::uint32_t>(pair >> 32), plane = static_cast<std::uint32_t>(pair);
    if (region != 0) table.region_size[region] += samples;
    if (plane != 0) table.plane_size[plane] += samples;
    if (region != 0 && plane != 0) table.overlaps.push_back({region, plane, samples});
  }
  const auto left_out = [&](std::uint32_t region) {
    return table.region_size.count(region) > 0 && out_of_count[region] > table.region_size[region];
  };
  std::erase_if(table.overlaps, [&](const auto& overlap) { return left_out(overlap.region); });
  for (const auto& [region, samples] : out_of_count)
    if (left_out(region)) table.region_size.erase(region);
  return table;
}

std::map<std::uint32_t, std::uint32_t> RegionTable::majority() const {
  std::map<std::uint32_t, std::uint32_t> plane_of;
  std::map<std::uint32_t, std::int64_t> most;
  for (const Overlap& overlap : overlaps)
    if (overlap.samples > most[overlap.region]) {
      most[overlap.region] = overlap.samples;
      plane_of[overlap.region] = overlap.plane;
    }
  return plane_of;
}

}  // namespace score
