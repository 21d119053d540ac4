#pragma once
#include <vector>

#include "io/e57/e57_source.hpp"
#include "io/scan_stream.hpp"

namespace hybrid::io {

// A scan's samples as the records of an E57 file: coordinates in single precision (double where the scan has
// an origin or exact ones), the state of no-returns, indices of its grid, intensity, colour. Samples beside
// the grid have no indices and are left out. Refers to the scan; one caller at a time.
class ScanRecords : public E57RecordReader {
 public:
  explicit ScanRecords(const ScanStream& scan);

  const E57Scan& description() const { return description_; }
  std::uint64_t count() const override { return description_.points.count; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override;

 private:
  enum Kind { x, y, z, invalid, row, column, intensity, red, green, blue };
  void add(Kind kind, E57Field field);
  std::int64_t whole(Kind kind, const SampleBlock& block, std::size_t i) const;
  static double real(Kind kind, const SampleBlock& block, std::size_t i);
  void read_block(std::span<const std::size_t> fields, std::uint64_t first, std::size_t count,
                  const std::function<void(const E57Records&)>& body) const;

  const ScanStream& scan_;
  E57Scan description_;
  std::vector<Kind> kinds_;             // by field
  std::vector<std::uint32_t> samples_;  // by record, where some are left out
};

// The same as all that a file holds.
class ScanAsE57 : public E57Source {
 public:
  explicit ScanAsE57(const ScanStream& scan);
  std::unique_ptr<E57RecordReader> open_stored(std::size_t part) const override;
  std::vector<char> blob(std::size_t part) const override;

 private:
  const ScanStream& scan_;
};

}  // namespace hybrid::io
