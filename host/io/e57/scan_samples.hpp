#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/e57/e57_model.hpp"
#include "io/e57/record_reader.hpp"
#include "io/e57/scan_colours.hpp"
#include "io/e57/scan_columns.hpp"

namespace hybrid::io {

// What of a range of records is no return, and why.
struct SampleTally {
  std::uint64_t not_finite = 0, invalid = 0, absurd = 0, lost = 0;
  std::uint64_t first_absurd = std::numeric_limits<std::uint64_t>::max();
  double absurd_value = 0;
};

// Makes samples of a scan's records: points in the scan frame relative to an origin, intensities, colours as
// bytes. Records come with the columns of columns().fields, in that order.
class ScanSamples {
 public:
  // Chooses the origin from the first returns and the scale of colours. Throws ErrorKind::input when there
  // are no coordinates; `where` names file and scan. Refers to `source` and its table.
  ScanSamples(const std::string& where, const E57Scan& source, const E57RecordReader& reader);

  const ScanColumns& columns() const { return columns_; }
  const Vec3& origin() const { return origin_; }

  // Whether the fields hold coordinates that points() rounds; where they are whole numbers, of what steps.
  bool rounds() const;
  std::optional<CoordinateSteps> steps() const;

  // One per record; NaN: no return. Lost records are left to the caller. `exact`: as the file has them,
  // absolute, or empty.
  void points(const E57Records& records, std::span<std::array<float, 3>> to, SampleTally& tally,
              std::span<std::array<double, 3>> exact = {}) const;
  // Where the columns have them. What is marked invalid is 0.
  void intensities(const E57Records& records, std::span<float> to) const;
  void colours(const E57Records& records, std::span<std::array<std::uint8_t, 3>> to) const;

 private:
  enum Kind { good, invalid, not_finite, absurd };
  struct Coordinates;
  Kind kind(const Coordinates& c, const std::vector<double>& state, std::size_t i) const;
  std::vector<double> values(const E57Records& records, const ScanColumns::Slot& slot) const;
  void choose_origin(const E57RecordReader& reader);

  const E57Table& table_;
  ScanColumns columns_;
  Vec3 origin_ = Vec3::Zero();
  std::optional<ColourScale> colours_;
};

}  // namespace hybrid::io
