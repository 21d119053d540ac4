#include "io/exr/exr_scan_reader.hpp"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"
#include "geometry/range_image.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/exr/range_checksum.hpp"
#include "io/exr/range_exr_header.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
using namespace range_attribute;
namespace {

// Grids of cameras and grids through the zenith have tables beyond a half turn; degrees are beyond this.
constexpr double kMostAngle_rad = 4 * std::numbers::pi;

bool descends(const std::vector<double>& angles) {
  return std::is_sorted(angles.rbegin(), angles.rend());
}

}  // namespace

ExrScanReader::ExrScanReader(const fs::path& path, bool salvage)
    : path_(path), file_(path.string()), salvage_(salvage) {
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

ScanEntry ExrScanReader::list() const {
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

void ExrScanReader::read_head(Scan& scan) {
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
  read_tables(scan);
}

std::int64_t ExrScanReader::extra_samples() const {
  return whole_attribute(file_, header(), kExtra).value_or(0);
}

void ExrScanReader::forgive(const std::string& problem, const char* remedy) {
  if (!salvage_) fail_input("{}: {}; {}, {}", file_, problem, remedy, kSalvageRemedy);
  notes_.push_back(problem);
}
void ExrScanReader::note_attributes(Scan& scan) const {
  for (auto at = header().begin(); at != header().end(); ++at) {
    const std::string name = at.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute());
    if (text && name.starts_with(kPrefix) && !is_range_attribute(name))
      scan.notes.push_back(name.substr(std::string_view(kPrefix).size()) + ": " + text->value());
  }
}

void ExrScanReader::read_tables(Scan& scan) {
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

void ExrScanReader::read_bands(bool wraps, const TakeBand& take) {
  const bool checked = is_range_format(text_attribute(header(), kFormat));
  ExrScanBand band(channels_, *in_);
  RangeChecksum sum(rows_, cols_, wraps, elevation_rad_, azimuth_rad_);
  std::uint64_t lost = 0;
  std::string problem;
  for (int row = 0; row < rows_; row += band.rows()) {
    const int count = std::min(band.rows(), rows_ - row);
    guarded([&] {
      try {
        band.read(*in_, row, count, checked && !salvage_);
      } catch (const std::exception&) {
        if (!salvage_) throw;
        lost += band.salvage(*in_, row, count, problem);
      }
    });
    if (checked) band.add_to(sum);
    take(band, row, count);
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

std::array<float, 3> ExrScanReader::point_of(const ExrScanBand& band, std::size_t at, int row,
                                             int col) const {
  if (channels_.points) return {band.x[at], band.y[at], band.z[at]};
  const double range = static_cast<double>(band.range[at]);
  if (!(range > 0)) return {kNaN, kNaN, kNaN};
  const double elevation = elevation_rad_[static_cast<std::size_t>(row)],
               azimuth = azimuth_rad_[static_cast<std::size_t>(col)];
  return {static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
          static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
          static_cast<float>(range * std::sin(elevation))};
}

float interpolated_range(const std::array<float, 3>& point, float range) {
  if (!std::isnan(range)) return range;
  return static_cast<float>(std::sqrt(double(point[0]) * double(point[0]) +
                                      double(point[1]) * double(point[1]) +
                                      double(point[2]) * double(point[2])));
}

bool is_place(const std::array<float, 3>& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]) &&
         (point[0] != 0 || point[1] != 0 || point[2] != 0);
}

bool is_absurd(const std::array<float, 3>& point) {
  const float most = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
  return std::isfinite(most) && static_cast<double>(most) > kAbsurd_m;
}

}  // namespace hybrid::io
