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
  std::unique_ptr<E57RecordReader> open(std::size_t part) const;
  virtual std::vector<char> blob(std::size_t part) const = 0;
  // The part that holds a scan's points.
  std::size_t points(std::size_t scan) const;
  // What salvage has to say of a scan's points.
  virtual std::vector<std::string> notes(std::size_t scan) const;

 protected:
  void describe(const std::string& name, std::string xml);
  void drop(std::string what) { dropped_.push_back(std::move(what)); }

  // For salvage, after describe(). Reads all once: records that are lost are left out, and the description
  // says how many there are now; so is what is damaged of pictures and other tables, and a scan's groups of
  // points when some of its points are lost, all of which dropped() names. Throws ErrorKind::input where the
  // points of a scan cannot be read at all.
  void leave_out_damage();
  // As stored, with what is lost; blob() throws for a damaged one.
  virtual std::unique_ptr<E57RecordReader> open_stored(std::size_t part) const = 0;
  std::uint64_t stored_count(std::size_t part) const;
  virtual void keep_parts(std::span<const std::size_t>) {}  // of the description before: the others are gone

 private:
  void cut_damaged_blobs(std::vector<TextEdit>& edits);
  std::optional<KeptRanges> find_kept_records(std::size_t part, std::vector<TextEdit>& edits);

  std::string name_, xml_;
  E57Contents contents_;
  E57Outline outline_;
  std::vector<E57Table> tables_;                 // by part; of blobs empty
  std::vector<std::optional<KeptRanges>> kept_;  // the same; none without salvage
  std::vector<std::string> dropped_;
};

// An E57 file's, or some of its scans with their photographs (those that belong to none stay). Fields of text
// are left out, and tables that cannot be read other than points; all are named in dropped(). Throws as
// E57File does; in salvage also where the description is damaged, or all points of one of the scans.
class E57FileSource : public E57Source {
 public:
  explicit E57FileSource(const std::filesystem::path& file,
                         const std::optional<std::set<std::size_t>>& scans = {},
                         const E57Options& options = {});
  std::vector<char> blob(std::size_t part) const override;
  std::vector<std::string> notes(std::size_t scan) const override;

 private:
  std::unique_ptr<E57RecordReader> open_stored(std::size_t part) const override;
  void keep_parts(std::span<const std::size_t> parts) override;

  E57File file_;
  std::vector<E57Table> stored_;  // by part, with fields of text
};

// Writes it all into an E57 file: every record of every table and every byte of every blob as it was, the
// XML with no change but the offsets. What E57Writer wrote comes out byte for byte. One block of records or
// one blob in memory. Parent folders, rename and errors as write_atomically().
void copy_e57(const E57Source& source, const std::filesystem::path& file);

}  // namespace hybrid::io
