#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/e57/e57.hpp"
#include "io/e57/e57_outline.hpp"
#include "io/e57/kept_records.hpp"
#include "io/e57/record_reader.hpp"

namespace hybrid::io {

// All that an E57 file holds, wherever it lies now: in the file, or in range images made from it. The
// description is the XML as its writer wrote it, with the offsets of that file, by which parts are known.
class E57Source {
 public:
  virtual ~E57Source() = default;

  const std::string& name() const { return name_; }
  const std::string& xml() const { return xml_; }
  const E57Contents& contents() const { return contents_; }             // of that XML
  const E57Outline& outline() const { return outline_; }                // the same
  const std::vector<std::string>& dropped() const { return dropped_; }  // by name, what is not in that XML

  // Of the part with this number in the outline: a table's description and records, a blob's bytes.
  const E57Table& table(std::size_t part) const { return tables_.at(part); }
  virtual std::unique_ptr<E57RecordReader> open(std::size_t part) const = 0;
  virtual std::vector<char> blob(std::size_t part) const = 0;
  // What salvage has to say of a part.
  virtual std::vector<std::string> notes(std::size_t) const { return {}; }
  // The part that holds a scan's points.
  std::size_t points(std::size_t scan) const;

 protected:
  void describe(const std::string& name, std::string xml);
  void drop(std::string what) { dropped_.push_back(std::move(what)); }

 private:
  std::string name_, xml_;
  E57Contents contents_;
  E57Outline outline_;
  std::vector<E57Table> tables_;  // by part; of blobs empty
  std::vector<std::string> dropped_;
};

// An E57 file's, or some of its scans with their photographs (those that belong to none stay). Fields of text
// are left out, and tables that cannot be read other than points; all are named in dropped(). Throws as
// E57File does.
// In salvage all is read once: records that are lost are left out and the description says how many there are
// now; so is what is damaged of pictures and other tables, and a scan's groups of points when some of its
// points are lost, all of which dropped() names. Throws ErrorKind::input when the description is damaged, or
// the points of one of the scans cannot be read at all.
class E57FileSource : public E57Source {
 public:
  explicit E57FileSource(const std::filesystem::path& file,
                         const std::optional<std::set<std::size_t>>& scans = {},
                         const E57Options& options = {});
  std::unique_ptr<E57RecordReader> open(std::size_t part) const override;
  std::vector<char> blob(std::size_t part) const override;
  std::vector<std::string> notes(std::size_t part) const override;

 private:
  struct Cuts;
  void cut_other_scans(Cuts& cuts, const std::set<std::size_t>& scans);
  void cut_damaged_blobs(Cuts& cuts);
  void keep_points(Cuts& cuts, const E57Part& part);
  bool keep_table(Cuts& cuts, const E57Part& part);
  KeptRanges kept_of(const E57Table& table) const;

  E57File file_;
  struct Stored {
    E57Table table{};  // with fields of text
    std::optional<KeptRanges> kept{};
  };
  std::vector<Stored> stored_;  // by part
};

// Writes it all into an E57 file: every record of every table and every byte of every blob as it was, the
// XML with no change but the offsets. What E57Writer wrote comes out byte for byte. One block of records or
// one blob in memory. Parent folders, rename and errors as write_atomically().
void copy_e57(const E57Source& source, const std::filesystem::path& file);

}  // namespace hybrid::io
