#include "io/exr/exr_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/error.hpp"
#include "geometry/colour.hpp"
#include "geometry/range_image.hpp"
#include "io/exr/exr_scan_reader.hpp"
#include "io/ply/ply.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
Scan ExrScanReader::read() {
  Scan scan;
  read_head(scan);
  const auto extra = extra_samples();
  allocate(scan);
  read_bands(scan.range_grid && scan.range_grid->wraps, [&](const ExrScanBand& band, int row, int count) {
    for (int r = 0; r < count; ++r) take_row(band, r, row + r, scan);
  });
  note_states(scan);
  if (extra > 0 && scan.range_grid) unless_salvaged([&] { add_extra(scan, extra); });
  scan.notes.insert(scan.notes.end(), notes_.begin(), notes_.end());
  return scan;
}

void ExrScanReader::allocate(Scan& scan) const {
  try {
    scan.points.assign(nodes(), {kNaN, kNaN, kNaN});
    if (channels_.intensity) scan.intensity.resize(nodes());
    if (channels_.colour) scan.rgb.resize(nodes());
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::device,
         "{}: expected {} MiB of memory for {} x {} nodes, found less free; use another machine", file_,
         nodes() * 19 >> 20, rows_, cols_);
  }
}

void ExrScanReader::take_row(const ExrScanBand& band, int band_row, int row, Scan& scan) {
  const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_);
  for (int col = 0; col < cols_; ++col) {
    const std::size_t at = band.index(band_row, col), node = first + static_cast<std::size_t>(col);
    if (channels_.intensity) scan.intensity[node] = band.intensity[at];
    if (channels_.colour)
      for (std::size_t c = 0; c < 3; ++c) scan.rgb[node][c] = srgb_byte(band.colour[3 * at + c]);
    const std::uint32_t state = channels_.mask ? band.mask[at] : std::uint32_t{kMeasured};
    if (state > kInterpolated && salvage_) {
      ++lost_;
      continue;
    }
    if (state > kInterpolated)
      fail_input(
          "{}: channel mask: row {}, column {}: expected 0 (empty), 1 (measured) or 2 (interpolated), "
          "found "
          "{}; write one of these, or no mask",
          file_, row, col, state);
    if (state == kEmpty) continue;
    const auto point = point_of(band, at, row, col);
    if (is_absurd(point)) {
      const auto problem =
          fmt::format("row {}, column {}: expected a coordinate within {} m, found {}", row, col, kAbsurd_m,
                      std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])}));
      if (absurd_++ == 0) forgive(problem, "write the image again");
      continue;
    }
    if (!is_place(point)) {
      lost_ += channels_.mask;
    } else if (state == kMeasured) {
      scan.points[node] = point;
    } else {
      ++interpolated_;
      if (!scan.range_grid) continue;
      const float range = interpolated_range(point, channels_.range ? band.range[at] : kNaN);
      scan.range_grid->interpolated.push_back(static_cast<std::uint32_t>(node));
      scan.range_grid->interpolated_point.push_back({point[0], point[1], point[2], range});
    }
  }
}

void ExrScanReader::note_states(Scan& scan) const {
  if (lost_ > 0)
    scan.notes.push_back(
        fmt::format("{} nodes that the mask calls measured or interpolated have no finite point: taken as "
                    "no-returns",
                    lost_));
  if (absurd_ > 0)
    scan.notes.push_back(fmt::format("{} nodes have absurd coordinates: taken as no-returns", absurd_));
  if (interpolated_ > 0 && !scan.range_grid)
    scan.notes.push_back(fmt::format("{} interpolated nodes are no samples: left out", interpolated_));
}

void ExrScanReader::add_extra(Scan& scan, std::int64_t count) const {
  const fs::path file = path_.parent_path() / "extra.ply";
  if (!fs::exists(file)) {
    scan.notes.push_back(
        fmt::format("{} samples beside the grid are missing: no extra.ply beside the range image", count));
    return;
  }
  const Scan extra = read_ply(file);
  if (extra.points.size() != static_cast<std::size_t>(count))
    fail_input("{}: expected {} points, as {} beside it says, found {}; copy both from one run, or remove it",
               file.string(), count, path_.filename().string(), extra.points.size());
  for (std::size_t i = 0; i < extra.points.size(); ++i) {
    const Vec3 point = extra.point(i);
    scan.points.push_back(
        {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())});
    if (channels_.intensity) scan.intensity.push_back(extra.intensity.empty() ? 0 : extra.intensity[i]);
    if (channels_.colour)
      scan.rgb.push_back(extra.rgb.empty() ? std::array<std::uint8_t, 3>{} : extra.rgb[i]);
  }
}

Scan read_exr_scan(const fs::path& file, const ReadOptions& options) {
  return ExrScanReader(file, options.salvage).read();
}

ScanEntry list_exr_scan(const fs::path& file, const ReadOptions& options) {
  return ExrScanReader(file, options.salvage).list();
}

std::optional<GridScan> read_exr_grid(const fs::path& file) {
  return ExrScanReader(file, false).read_grid();
}

}  // namespace hybrid::io
