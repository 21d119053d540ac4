#include "io/exr_scan.hpp"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>

#include "core/error.hpp"
#include "geometry/range_image.hpp"
#include "io/exr_errors.hpp"
#include "io/exr_header.hpp"
#include "io/exr_parts.hpp"
#include "io/exr_scan_band.hpp"
#include "io/exr_threads.hpp"
#include "io/input_file.hpp"
#include "io/ply.hpp"
#include "io/range_checksum.hpp"
#include "io/range_exr_header.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;
using namespace range_attribute;

// Grids of cameras and grids through the zenith have tables beyond a half turn; degrees are beyond this.
constexpr double kMostAngle_rad = 4 * std::numbers::pi;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

bool descends(const std::vector<double>& angles) {
  return std::is_sorted(angles.rbegin(), angles.rend());
}

class Reader {
 public:
  Reader(const fs::path& path, bool salvage) : path_(path), file_(path.string()), salvage_(salvage) {
    guarded([&] { in_ = std::make_unique<ExrParts>(path, start_exr_threads()); });
    if (!in_->complete())
      forgive("tiles: expected all tiles or lines, found some missing",
              "the file is cut short: copy or write it again");
    rows_ = in_->rows();
    cols_ = in_->cols();
    if (nodes() > std::numeric_limits<std::uint32_t>::max() - 1)
      fail_input("{}: header: expected fewer than 2^32 nodes, found {} x {}; split the image", file_, rows_,
                 cols_);
  }

  ScanEntry list() const {
    ScanEntry entry;
    entry.name = path_.stem().string();
    entry.samples = nodes();
    if (const auto extra = whole_attribute(file_, header(), kExtra); extra && *extra > 0)
      entry.samples += static_cast<std::uint64_t>(*extra);
    entry.grid_rows = rows_;
    entry.grid_cols = cols_;
    entry.structure = "range image:";
    for (auto at = header().channels().begin(); at != header().channels().end(); ++at)
      entry.structure += std::string(" ") + at.name();
    entry.unit = std::string("m");
    return entry;
  }

  Scan read() {
    Scan scan;
    scan.name = path_.stem().string();
    scan.grid_rows = rows_;
    scan.grid_cols = cols_;
    scan.row_by_row = true;
    unless_salvaged([&] { scan.world_from_scan = pose_attribute(file_, header()); });
    channels_ = find_exr_scan_channels(file_, header());
    scan.notes = notes_;
    scan.notes.insert(scan.notes.end(), channels_.notes.begin(), channels_.notes.end());
    notes_.clear();
    note_attributes(scan);
    // Before memory is taken for the samples: the tables have an angle per row and column.
    read_grid(scan);
    const auto extra = whole_attribute(file_, header(), kExtra).value_or(0);
    allocate(scan);
    read_bands(scan);
    note_states(scan);
    if (extra > 0 && scan.range_grid) unless_salvaged([&] { add_extra(scan, extra); });
    scan.notes.insert(scan.notes.end(), notes_.begin(), notes_.end());
    return scan;
  }

 private:
  const Imf::Header& header() const { return in_->header(); }
  std::uint64_t nodes() const {
    return static_cast<std::uint64_t>(rows_) * static_cast<std::uint64_t>(cols_);
  }

  // An error, in salvage a note.
  void forgive(const std::string& problem, const char* remedy) {
    if (!salvage_) fail_input("{}: {}; {}, {}", file_, problem, remedy, kSalvageRemedy);
    notes_.push_back(problem);
  }
  template <typename Body>
  void unless_salvaged(const Body& body) {
    try {
      body();
    } catch (const Error& error) {
      if (!salvage_ || error.kind() != ErrorKind::input) throw;
      notes_.push_back(Damage(file_).shortened(error.what()) + ": left out");
    }
  }

  template <typename Body>
  void guarded(const Body& body) const {
    with_exr_errors(body, [&](const char* what) {
      fail_input(
          "{}: expected an OpenEXR range image, found another or a damaged file ({}); copy or write it "
          "again, {}",
          file_, what, kSalvageRemedy);
    });
  }

  void note_attributes(Scan& scan) const {
    for (auto at = header().begin(); at != header().end(); ++at) {
      const std::string name = at.name();
      const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute());
      if (text && name.starts_with(kPrefix) && !is_range_attribute(name))
        scan.notes.push_back(name.substr(std::string_view(kPrefix).size()) + ": " + text->value());
    }
  }

  void read_grid(Scan& scan) {
    elevation_rad_ = angle_attribute(file_, header(), kElevationAttributes, rows_, kMostAngle_rad);
    azimuth_rad_ = angle_attribute(file_, header(), kAzimuthAttributes, cols_, kMostAngle_rad);
    if (!channels_.points && (elevation_rad_.empty() || azimuth_rad_.empty()))
      fail_input(
          "{}: header: expected {} (or {} and {}), as there are ranges without x y z, found no such "
          "attribute; write the {} angles in radians, or channels x y z",
          file_, elevation_rad_.empty() ? kElevation : kAzimuth,
          elevation_rad_.empty() ? kElevationFirst : kAzimuthFirst,
          elevation_rad_.empty() ? kElevationStep : kAzimuthStep, elevation_rad_.empty() ? rows_ : cols_);
    if (elevation_rad_.empty() || azimuth_rad_.empty()) return;
    const auto wraps = whole_attribute(file_, header(), kWraps);
    if (!descends(elevation_rad_) || !std::is_sorted(azimuth_rad_.begin(), azimuth_rad_.end())) {
      scan.notes.push_back("the angle tables do not run down and around: the grid is found from the points");
      return;
    }
    RangeGrid& grid = scan.range_grid.emplace();
    grid.elevation_rad = elevation_rad_;
    grid.azimuth_rad = azimuth_rad_;
    grid.wraps = wraps ? *wraps != 0 : is_full_turn(azimuth_rad_);
  }

  void allocate(Scan& scan) const {
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

  void read_bands(Scan& scan) {
    const bool checked = is_range_format(text_attribute(header(), kFormat));
    ExrScanBand band(channels_, *in_);
    RangeChecksum sum(rows_, cols_, scan.range_grid && scan.range_grid->wraps, elevation_rad_, azimuth_rad_);
    std::uint64_t lost = 0;
    std::string problem;
    for (int row = 0; row < rows_; row += band.rows()) {
      const int count = std::min(band.rows(), rows_ - row);
      guarded([&] {
        try {
          if (!checked || salvage_) in_->check(row, count);
          band.read(*in_, row, count);
        } catch (const std::exception&) {
          if (!salvage_) throw;
          lost += band.salvage(*in_, row, count, problem);
        }
      });
      if (checked) band.add_to(sum);
      for (int r = 0; r < count; ++r) take_row(band, r, row + r, scan);
    }
    if (lost == nodes() && lost > 0)
      fail_input("{}: {}, and so in all of it; copy or write it again", file_, problem);
    if (lost > 0) {
      Damage damage(file_);
      damage.add(lost, problem);
      notes_.push_back(damage.note(nodes()));
    } else if (checked && sum.text() != text_attribute(header(), kChecksum)) {
      forgive(fmt::format("content: expected checksum {}, found {}", text_attribute(header(), kChecksum),
                          sum.text()),
              "the file is damaged: copy or write it again");
    }
  }

  void take_row(const ExrScanBand& band, int band_row, int row, Scan& scan) {
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
      const float most = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
      if (std::isfinite(most) && static_cast<double>(most) > kAbsurd_m) {
        const auto problem = fmt::format("row {}, column {}: expected a coordinate within {} m, found {}",
                                         row, col, kAbsurd_m, most);
        if (absurd_++ == 0) forgive(problem, "write the image again");
        continue;
      }
      const bool finite = std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]) &&
                          (point[0] != 0 || point[1] != 0 || point[2] != 0);
      if (!finite) {
        lost_ += channels_.mask;
      } else if (state == kMeasured) {
        scan.points[node] = point;
      } else {
        ++interpolated_;
        if (scan.range_grid)
          add_interpolated(*scan.range_grid, node, point, channels_.range ? band.range[at] : kNaN);
      }
    }
  }

  std::array<float, 3> point_of(const ExrScanBand& band, std::size_t at, int row, int col) const {
    if (channels_.points) return {band.x[at], band.y[at], band.z[at]};
    const double range = static_cast<double>(band.range[at]);
    if (!(range > 0)) return {kNaN, kNaN, kNaN};
    const double elevation = elevation_rad_[static_cast<std::size_t>(row)],
                 azimuth = azimuth_rad_[static_cast<std::size_t>(col)];
    return {static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
            static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
            static_cast<float>(range * std::sin(elevation))};
  }

  static void add_interpolated(RangeGrid& grid, std::size_t node, const std::array<float, 3>& point,
                               float range) {
    if (std::isnan(range))
      range = static_cast<float>(std::sqrt(double(point[0]) * double(point[0]) +
                                           double(point[1]) * double(point[1]) +
                                           double(point[2]) * double(point[2])));
    grid.interpolated.push_back(static_cast<std::uint32_t>(node));
    grid.interpolated_point.push_back({point[0], point[1], point[2], range});
  }

  void note_states(Scan& scan) const {
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

  void add_extra(Scan& scan, std::int64_t count) const {
    const fs::path file = path_.parent_path() / "extra.ply";
    if (!fs::exists(file)) {
      scan.notes.push_back(
          fmt::format("{} samples beside the grid are missing: no extra.ply beside the range image", count));
      return;
    }
    const Scan extra = read_ply(file);
    if (extra.points.size() != static_cast<std::size_t>(count))
      fail_input(
          "{}: expected {} points, as {} beside it says, found {}; copy both from one run, or remove it",
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

  fs::path path_;
  std::string file_;
  std::unique_ptr<ExrParts> in_;
  int rows_ = 0, cols_ = 0;
  ExrScanChannels channels_;
  std::vector<double> elevation_rad_, azimuth_rad_;
  std::uint64_t lost_ = 0, interpolated_ = 0, absurd_ = 0;
  bool salvage_ = false;
  std::vector<std::string> notes_;
};

}  // namespace

Scan read_exr_scan(const fs::path& file, const ReadOptions& options) {
  return Reader(file, options.salvage).read();
}

ScanEntry list_exr_scan(const fs::path& file, const ReadOptions& options) {
  return Reader(file, options.salvage).list();
}

}  // namespace hybrid::io
