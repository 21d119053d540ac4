#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/e57/e57.hpp"
#include "io/e57/scan_grid.hpp"
#include "io/e57/scan_samples.hpp"
#include "io/scan_stream.hpp"

namespace hybrid::io {

// What row and column indices say of a scan's grid, found in one pass over them (two where the file declares
// other bounds than they have).
struct GridOutline {
  ScanGrid::Bounds row, column;
  bool grid = false, several_returns = false;         // of a node
  bool column_by_column = false, row_by_row = false;  // all nodes have a sample, in this order
  std::string note;                                   // why there is none
};
GridOutline outline_grid(const E57Scan& scan, const ScanColumns& columns, const E57RecordReader& reader,
                         bool salvage);

// Records as read_e57() makes samples of them, decoded again at every pass. In memory: a block, and a byte
// per node where there are several returns of a node. Keeps `owner`, to which contents and reader refer,
// alive.
class E57Stream : public ScanStream {
 public:
  static std::unique_ptr<ScanStream> open(const std::string& file, const E57Contents& contents,
                                          std::size_t index, std::unique_ptr<E57RecordReader> reader,
                                          const ScanEntry& entry, std::shared_ptr<const void> owner);
  // Of a file; and with what E57File::notes() tells. In salvage what is lost is a no-return without a node.
  static std::unique_ptr<ScanStream> open(const std::filesystem::path& file, const ScanEntry& entry);

 private:
  E57Stream(const std::string& file, const E57Scan& source, std::unique_ptr<E57RecordReader> reader,
            bool salvage);
  void take(const GridOutline& grid, const ScanEntry& entry);
  void find_first_returns();
  std::uint32_t node_of(const E57Records& records, std::size_t i) const;
  std::uint8_t return_of(const E57Records& records, std::size_t i) const;
  SampleBlock load(std::uint64_t first, std::size_t count) const override;

  std::shared_ptr<const void> owner_;
  const E57Scan& source_;
  std::string where_;
  std::unique_ptr<E57RecordReader> reader_;
  ScanSamples samples_;
  bool salvage_;
  ScanGrid::Bounds row_, column_;
  std::vector<std::uint8_t> first_return_;  // of several, the least valid one by node; else empty
  mutable bool measuring_ = false;
  mutable std::vector<SampleTally> tallies_;  // of the blocks measured so far
  mutable SampleColumns block_;
};

}  // namespace hybrid::io
