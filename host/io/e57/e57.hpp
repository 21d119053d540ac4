#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/e57/e57_model.hpp"
#include "io/e57/paged_file.hpp"
#include "io/e57/table_reader.hpp"
#include "io/grid_scan.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

struct E57Options {
  // Uses what is good of a damaged file and notes what is lost, instead of failing.
  bool salvage = false;
};

// An E57 file (ASTM E2807-11): its description is read at once, scans and pictures when asked for, one
// without the others. Throws ErrorKind::input naming file, place, expectation and finding; never takes memory
// beyond what the file's size can hold.
class E57File {
 public:
  explicit E57File(const std::filesystem::path& file, const E57Options& options = {});

  const std::string& name() const { return pages_.name(); }
  const E57Contents& contents() const { return contents_; }
  const std::vector<std::string>& notes() const { return notes_; }  // oddities of the file as a whole
  const PagedFile& pages() const { return pages_; }

  // A scan's records as stored; the reader refers to this file.
  E57TableReader open(const E57Table& table) const { return {pages_, table}; }
  // The same, columns of up to `most` records at a time, in file order, of the fields with these indices.
  void for_each_block(const E57Table& table, std::span<const std::size_t> fields, std::size_t most,
                      const std::function<void(const E57Records&)>& body) const;

  // The description itself, as it is written; in salvage what can be read of it, and whether that is all.
  std::string xml(bool* whole = nullptr) const;

  // A picture's bytes (JPEG or PNG). In salvage damaged pages are noted.
  std::vector<char> read_blob(const E57Blob& blob, const std::string& what,
                              std::vector<std::string>* notes = nullptr) const;

 private:
  PagedFile pages_;
  E57Contents contents_;
  std::vector<std::string> notes_;
};

// One scan as samples in the scan frame (Cartesian; spherical ones are converted in double): no-returns and
// points marked invalid are NaN; large coordinates become relative to Scan::origin; rowIndex and columnIndex
// make the grid (Scan::node); colours become bytes by their limits. Intensities keep the file's values
// (stored * scale + offset): what they mean is for the reader to say who knows the scanner, so the file's
// limits are given in a note. Scan::name is the file's stem, with the index when there are several scans;
// fields that Scan does not hold are listed in a note.
// With `exact` coordinates that float would round are kept, too (Scan::exact).
Scan read_e57(const E57File& file, std::size_t index, bool exact = false);
// The same of records that lie elsewhere, but without what E57File::notes() tells.
Scan read_e57(const std::string& file, const E57Contents& contents, std::size_t index,
              const E57RecordReader& reader, const ReadOptions& options);
// One scan with its samples in their nodes, where that can be done (grid_scan.hpp).
std::optional<GridScan> read_e57_grid(const E57File& file, std::size_t index);
// Of every scan in a file. In salvage a scan that cannot be read is left out, with a note at the others;
// throws when none can.
std::vector<Scan> read_e57(const std::filesystem::path& file, const E57Options& options = {});

}  // namespace hybrid::io
