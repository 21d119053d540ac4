#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/e57/e57_model.hpp"
#include "io/e57/record_reader.hpp"

// The range image that keeps records exactly as an E57 file stores them ("records 1"): one node per record,
// on the records' own grid or as a list, with the values that viewers and other programs know (range, x y z,
// mask, intensity, R G B) beside the stored ones (channels raw.*). README, "Records in range images".
namespace hybrid::io {

namespace records_attribute {
inline constexpr const char* kRecordsFormatName = "records 1";
inline constexpr const char* kSamples = "hybrid:samples";         // records
inline constexpr const char* kLayout = "hybrid:layout";           // "grid R C ..." or "list": RecordLayout
inline constexpr const char* kXml = "hybrid:e57_xml";             // the file's description without its scans
inline constexpr const char* kCuts = "hybrid:e57_scan_places";    // where in it each scan's goes, in bytes
inline constexpr const char* kScanXml = "hybrid:e57_scan_xml";    // this scan's, or this table's
inline constexpr const char* kScan = "hybrid:e57_scan";           // its index there
inline constexpr const char* kParts = "hybrid:e57_parts";         // the folder beside with blobs and tables
inline constexpr const char* kPartSums = "hybrid:e57_part_sums";  // of its blobs: "OFFSET:XXH3 ..."
inline constexpr const char* kTileSums = "hybrid:tile_xxh3";      // XXH3-64 of each, row by row
inline constexpr const char* kOrigin = "hybrid:origin";           // of x y z, metres, where they are large
}  // namespace records_attribute

// Where records lie. Rows [0, grid_rows) are the grid, in which a record's row and column follow from its
// indices; records that share a node with an earlier one, and all of a list, lie row by row from list_row on.
struct RecordLayout {
  std::uint64_t samples = 0;
  int rows = 1, cols = 1;           // of the whole image
  int grid_rows = 0, list_row = 0;  // list_row: a multiple of the tile's side
  bool by_columns = false;          // neighbouring records lie in a column: tiles go column by column
  // rowIndex = row_first + row_step * row, columnIndex = column_first + column_step * column
  std::int64_t row_first = 0, row_step = 1, column_first = 0, column_step = 1;

  bool grid() const { return grid_rows > 0; }
  bool has_list() const { return list_row < rows; }
  std::uint64_t pixels() const { return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(cols); }
  std::string text() const;
  static RecordLayout parse(const std::string& file, const std::string& text, std::uint64_t samples);
};

// A rectangle of tiles that is written and read at once: a row of them, or of the grid a column.
struct RecordGroup {
  int tile_x = 0, tile_y = 0, tiles_x = 0, tiles_y = 0;
  int x = 0, y = 0, width = 0, height = 0;  // pixels
  std::size_t index(std::uint32_t pixel, int cols) const {
    return static_cast<std::size_t>(static_cast<int>(pixel / static_cast<std::uint32_t>(cols)) - y) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(static_cast<int>(pixel % static_cast<std::uint32_t>(cols)) - x);
  }
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};
std::vector<RecordGroup> groups_of(const RecordLayout& layout);
std::size_t group_at(const RecordLayout& layout, std::uint32_t pixel);

// How a field's values stand in channels, all of 32 bits. Whole numbers as their distance from the field's
// minimum: one uint channel, or two above 32 bits. Single precision: one float channel. Doubles: two uint
// channels with the halves of their 64 bits, as two floats hold 48 of a double's 53 digits at most and none
// of its range. Nothing for fields of one value, and for the indices of a grid without a list.
struct FieldChannels {
  enum Kind { constant, from_row, from_column, word, two_words, single, double_halves };
  Kind kind = constant;
  std::vector<std::string> names;  // the lower half first
  bool is_float() const { return kind == single; }
};
std::vector<FieldChannels> channels_of(const E57Table& table, const RecordLayout& layout);

// The layout for these records, from their indices where they are a grid.
struct RecordPlan {
  RecordLayout layout;
  std::vector<std::uint64_t> last;  // of each group: the last of its records, or kNone
  static constexpr std::uint64_t kNone = ~0ull;
};
RecordPlan plan_records(const E57Table& table, const E57RecordReader& reader);

// Gives records their pixels, in order.
class RecordPlaces {
 public:
  explicit RecordPlaces(const RecordLayout& layout);
  // The rows and columns are the records' indices; not used for a list.
  void next(std::span<const std::int64_t> rows, std::span<const std::int64_t> columns,
            std::span<std::uint32_t> pixels);
  std::uint64_t listed() const { return listed_; }

 private:
  const RecordLayout layout_;
  std::vector<bool> taken_;
  std::uint64_t listed_ = 0;
};

// What the header says besides the samples.
struct RecordsDescription {
  std::string xml{};                // of the file without its scans; empty for a table that is no scan
  std::vector<std::size_t> cuts{};  // one per scan of the file
  std::string scan_xml{};
  std::size_t scan = 0;
  std::string parts{};                              // a folder's name, or empty
  std::string part_sums{};                          // of the blobs in there; older images have none
  std::map<std::string, std::string> attributes{};  // for people, without the prefix
};

// Writes a scan's records (or a table's, which has no coordinates). Reads them twice. In memory: the groups
// between their first and last record (of a scanner's order one or two of 256 rows or columns), and a bit per
// node.
void write_exr_records(const std::filesystem::path& file, const E57Scan& scan, const E57RecordReader& reader,
                       const RecordsDescription& description);

// Of any file: whether it is such an image. Throws ErrorKind::input when it is no image.
bool holds_exr_records(const std::filesystem::path& file);

// The image again, as records in their order. In memory: groups as in writing, a bit per record, and four
// bytes for each where they are in no scanner's order.
class ExrRecords : public E57RecordReader {
 public:
  // The header alone.
  explicit ExrRecords(const std::filesystem::path& file, bool salvage = false);
  ~ExrRecords() override;
  const RecordLayout& layout() const;
  const RecordsDescription& description() const;

  // Before the first read(): which table the channels hold. Reads the image once: finds every record and
  // checks the content. Throws ErrorKind::input; in salvage records of damaged tiles are lost instead, as far
  // as the header's checksums are there and tell which they are.
  void open(const E57Table& table);
  std::uint64_t count() const override;
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hybrid::io
