#include "score/measure/planes_hoover.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace score {
namespace {

enum class Rule { correct, over, under };

// One correct, over- or under-segmented instance: the regions and planes it ties together.
struct Mapping {
  Rule rule;
  std::vector<std::uint32_t> regions, planes;
  double mean_share;
};

struct Shares {
  std::int64_t common = 0, sizes = 0;
  std::vector<std::uint32_t> members;
};

std::vector<Mapping> find_mappings(const RegionTable& table, double overlap) {
  std::vector<Mapping> mappings;
  std::map<std::uint32_t, Shares> parts_of_plane, planes_of_region;
  for (const auto& [region, plane, samples] : table.overlaps) {
    const std::int64_t region_size = table.region_size.at(region), plane_size = table.plane_size.at(plane);
    const double of_region = static_cast<double>(samples) / static_cast<double>(region_size);
    const double of_plane = static_cast<double>(samples) / static_cast<double>(plane_size);
    if (of_region >= overlap && of_plane >= overlap)
      mappings.push_back({Rule::correct, {region}, {plane}, (of_region + of_plane) / 2});
    const auto add = [&](Shares& shares, std::uint32_t member, std::int64_t size) {
      shares.common += samples;
      shares.sizes += size;
      shares.members.push_back(member);
    };
    if (of_region >= overlap) add(parts_of_plane[plane], region, region_size);
    if (of_plane >= overlap) add(planes_of_region[region], plane, plane_size);
  }
  const auto group = [&](Rule rule, std::uint32_t whole, std::int64_t whole_size, const Shares& parts) {
    const double of_whole = static_cast<double>(parts.common) / static_cast<double>(whole_size);
    const double of_parts = static_cast<double>(parts.common) / static_cast<double>(parts.sizes);
    if (parts.members.size() < 2 || of_whole < overlap || of_parts < overlap) return;
    const bool over = rule == Rule::over;
    mappings.push_back({rule, over ? parts.members : std::vector{whole},
                        over ? std::vector{whole} : parts.members, (of_whole + of_parts) / 2});
  };
  for (const auto& [plane, parts] : parts_of_plane)
    group(Rule::over, plane, table.plane_size.at(plane), parts);
  for (const auto& [region, parts] : planes_of_region)
    group(Rule::under, region, table.region_size.at(region), parts);
  std::stable_sort(mappings.begin(), mappings.end(), [](const Mapping& a, const Mapping& b) {
    return std::make_tuple(-a.mean_share, a.rule) < std::make_tuple(-b.mean_share, b.rule);
  });
  return mappings;
}

}  // namespace

HooverScore score_hoover(const RegionTable& table, double overlap, std::int64_t min_samples,
                         const Normals& region_normals, const Normals& plane_normals) {
  HooverScore score;
  score.overlap = overlap;
  score.planes = static_cast<int>(table.plane_size.size());
  std::set<std::uint32_t> used_regions, used_planes;
  const auto taken = [](const std::set<std::uint32_t>& used, const std::vector<std::uint32_t>& members) {
    return std::any_of(members.begin(), members.end(), [&](std::uint32_t id) { return used.count(id) > 0; });
  };
  double angles = 0;
  for (const Mapping& mapping : find_mappings(table, overlap)) {
    if (taken(used_regions, mapping.regions) || taken(used_planes, mapping.planes)) continue;
    used_regions.insert(mapping.regions.begin(), mapping.regions.end());
    used_planes.insert(mapping.planes.begin(), mapping.planes.end());
    if (mapping.rule == Rule::over) ++score.over_segmented;
    if (mapping.rule == Rule::under) {
      ++score.under_segmented;
      score.planes_under_segmented += static_cast<int>(mapping.planes.size());
    }
    if (mapping.rule != Rule::correct) continue;
    ++score.correct;
    score.region_of_plane[mapping.planes[0]] = mapping.regions[0];
    const auto ours = region_normals.find(mapping.regions[0]);
    const auto truth = plane_normals.find(mapping.planes[0]);
    if (ours == region_normals.end() || truth == plane_normals.end()) continue;
    ++score.angles;
    const double angle = angle_between_deg(ours->second, truth->second);
    angles += std::min(angle, 180 - angle);  // a plane has two normals
  }
  if (score.angles > 0) score.mean_angle_deg = angles / score.angles;
  score.missed = score.planes - static_cast<int>(used_planes.size());
  for (const auto& [region, size] : table.region_size)
    if (used_regions.count(region) == 0) {
      ++score.noise;
      score.small_noise += size < min_samples;
    }
  return score;
}

}  // namespace score
