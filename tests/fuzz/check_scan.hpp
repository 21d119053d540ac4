#pragma once
#include <cstring>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/error.hpp"
#include "geometry/scan.hpp"
#include "io/grid_scan.hpp"

namespace hybrid::testing {

inline void expect(bool truth, const char* promise) {
  if (!truth) throw std::logic_error(promise);
}

// What every reader promises of a scan.
inline void check_scan(const Scan& scan) {
  const std::size_t count = scan.points.size();
  expect(scan.intensity.empty() || scan.intensity.size() == count, "an intensity per point");
  expect(scan.rgb.empty() || scan.rgb.size() == count, "a colour per point");
  expect(scan.node.empty() || scan.node.size() == count, "a node per point");
  expect(scan.origin.allFinite(), "a finite origin");
  expect(scan.grid_rows >= 0 && scan.grid_cols >= 0, "a grid of no negative size");
  const std::size_t nodes =
      static_cast<std::size_t>(scan.grid_rows) * static_cast<std::size_t>(scan.grid_cols);
  for (const std::uint32_t node : scan.node)
    expect(node < nodes || node == Scan::kNoNode, "nodes within the grid");
  if (scan.organised() && scan.node.empty()) expect(count >= nodes, "a sample per node");
  if (scan.range_grid) {
    expect(scan.range_grid->elevation_rad.size() == static_cast<std::size_t>(scan.grid_rows) &&
               scan.range_grid->azimuth_rad.size() == static_cast<std::size_t>(scan.grid_cols),
           "an angle per row and column");
    for (const std::uint32_t node : scan.range_grid->interpolated) expect(node < nodes, "nodes to be there");
  }
  if (scan.world_from_scan)
    expect(
        scan.world_from_scan->translation.allFinite() && scan.world_from_scan->rotation.coeffs().allFinite(),
        "a finite pose");
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// A scan that reads without salvage is intact: salvage must not change it.
inline void check_salvage(const std::optional<Scan>& strict, const std::optional<Scan>& salvaged) {
  if (strict) check_scan(*strict);
  if (salvaged) check_scan(*salvaged);
  if (!strict) return;
  expect(salvaged.has_value(), "salvage to read what is intact");
  expect(same_bytes(strict->points, salvaged->points) && same_bytes(strict->intensity, salvaged->intensity) &&
             same_bytes(strict->rgb, salvaged->rgb) && same_bytes(strict->node, salvaged->node),
         "salvage to leave what is intact");
}

// Its result, or nothing where it refuses.
template <typename Body>
auto unless_refused(const Body& body) -> std::optional<decltype(body())> {
  try {
    return body();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    return {};
  }
}

// Samples in their nodes at once are the samples of the list.
inline void check_grid(const io::GridScan& grid, const std::optional<Scan>& scan) {
  expect(scan.has_value(), "a list of samples where there is a grid of them");
  expect(grid.samples == scan->points.size(), "as many samples");
  expect(grid.image.rows == scan->grid_rows && grid.image.cols == scan->grid_cols, "the same grid");
  for (std::size_t i = 0; i < grid.image.count(); ++i) {
    if (grid.image.mask[i] != kMeasured) continue;
    const auto& point = scan->points.at(grid.image.source[i]);
    expect(point[0] == grid.image.x[i] && point[1] == grid.image.y[i] && point[2] == grid.image.z[i],
           "the same samples");
  }
}

}  // namespace hybrid::testing
