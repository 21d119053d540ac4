#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "geometry/scan.hpp"
#include "io/exr/exr_errors.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/exr/exr_scan_band.hpp"
#include "io/grid_scan.hpp"
#include "io/salvage.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// What exr_scan.hpp promises.
class ExrScanReader {
 public:
  ExrScanReader(const std::filesystem::path& path, bool salvage);

  ScanEntry list() const;
  Scan read();
  // The same as an image, where the file has its tables, no samples beside the grid and no problem.
  std::optional<GridScan> read_grid();

 private:
  const Imf::Header& header() const { return in_->header(); }
  std::uint64_t nodes() const {
    return static_cast<std::uint64_t>(rows_) * static_cast<std::uint64_t>(cols_);
  }
  // An error, in salvage a note.
  void forgive(const std::string& problem, const char* remedy);
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

  // Name, extent, pose, notes, and the tables where they run as an image's do; all that comes before memory
  // is taken for the samples, of which the tables have an angle per row and column.
  void read_head(Scan& scan);
  void note_attributes(Scan& scan) const;
  void read_tables(Scan& scan);
  std::int64_t extra_samples() const;
  // Calls take(band, first row, rows) band after band; then checks what all of it adds up to.
  using TakeBand = std::function<void(const ExrScanBand&, int, int)>;
  void read_bands(bool wraps, const TakeBand& take);
  std::array<float, 3> point_of(const ExrScanBand& band, std::size_t at, int row, int col) const;

  void allocate(Scan& scan) const;
  void take_row(const ExrScanBand& band, int band_row, int row, Scan& scan);
  void note_states(Scan& scan) const;
  void add_extra(Scan& scan, std::int64_t count) const;

  // Of a row that was put into an image.
  struct Placed {
    std::uint64_t measured = 0, lost = 0;
    bool problem = false;
  };
  Placed place_row(const ExrScanBand& band, int band_row, int row, RangeImage& image) const;

  std::filesystem::path path_;
  std::string file_;
  std::unique_ptr<ExrParts> in_;
  int rows_ = 0, cols_ = 0;
  ExrScanChannels channels_;
  std::vector<double> elevation_rad_, azimuth_rad_;
  std::uint64_t lost_ = 0, interpolated_ = 0, absurd_ = 0;
  bool salvage_ = false;
  std::vector<std::string> notes_;
};

// The range of an interpolated node: as stored, or of its point where there is none.
float interpolated_range(const std::array<float, 3>& point, float range);
bool is_place(const std::array<float, 3>& point);  // finite, and not the origin
bool is_absurd(const std::array<float, 3>& point);

}  // namespace hybrid::io
