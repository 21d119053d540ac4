#include "score/measure/plane_list.hpp"

#include <algorithm>
#include <map>

#include "score/measure/region_table.hpp"

namespace score {

std::vector<PlaneRow> list_planes(const JoinedScan& scan) {
  const RegionTable table = count_overlaps(scan, Planes::that_count);
  std::map<std::uint32_t, PlaneRow> rows;
  std::map<std::uint32_t, std::int64_t> on_planes;  // by region
  for (const auto& [plane, samples] : table.plane_size) rows[plane] = {plane, samples, 0, 0, samples};
  for (const auto& [region, plane, samples] : table.overlaps) {
    PlaneRow& row = rows.at(plane);
    on_planes[region] += samples;
    row.unlabelled -= samples;
    if (samples <= row.common) continue;
    row.region = region;
    row.common = samples;
  }
  std::map<std::uint32_t, std::int64_t> curved;  // by region
  for (std::size_t i = 0; i < scan.kind.size(); ++i)
    if (scan.kind[i] == kCurved && scan.label[i] != 0) ++curved[scan.label[i]];
  std::vector<PlaneRow> list;
  for (auto& [plane, row] : rows) {
    if (row.region != 0) {
      row.of_region = table.region_size.at(row.region);
      row.strangers = on_planes.at(row.region) - row.common;
      row.curved = curved[row.region];
      row.mixed = row.of_region - on_planes.at(row.region) - row.curved;
    }
    list.push_back(row);
  }
  const auto worst = [](const PlaneRow& row) {
    return std::min(row.share_of_plane(), row.share_of_region());
  };
  std::stable_sort(list.begin(), list.end(), [&](const PlaneRow& a, const PlaneRow& b) {
    return worst(a) != worst(b) ? worst(a) < worst(b) : a.samples > b.samples;
  });
  return list;
}

}  // namespace score
