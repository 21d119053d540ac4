#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/e57/e57_source.hpp"
#include "io/exr/exr_records.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// Range images with records (exr_records.hpp) as the E57 file they were made from: one of its scans, or
// several, in any order. What belongs to scans that are not given is left out. Throws ErrorKind::input: no
// such images, of different files, one twice, damaged; in salvage as E57Source::leave_out_damage().
class ExrSource : public E57Source {
 public:
  explicit ExrSource(const std::vector<std::filesystem::path>& files, bool salvage = false);
  std::vector<char> blob(std::size_t part) const override;

 private:
  std::unique_ptr<E57RecordReader> open_stored(std::size_t part) const override;
  std::filesystem::path part_file(std::size_t part) const;

  struct Image {
    std::filesystem::path file;
    RecordsDescription description;
  };
  std::vector<Image> images_;  // by scan
  bool salvage_;
};

// Where a source's blobs and other tables go: `<stem>.parts` beside its range images, and each one's name in
// there, which is made of its element and its offset in the original file.
std::filesystem::path parts_folder(const std::filesystem::path& exr);
std::string part_name(const E57Part& part);

// Writes one scan of a source as a range image with records, which names the folder of its parts and keeps
// what write_exr_parts() returned.
void write_exr_scan(const E57Source& source, std::size_t scan, const std::filesystem::path& file,
                    const std::filesystem::path& folder, const std::string& part_sums = {});
// Writes all blobs and tables but points into the folder; nothing without any. Returns the blobs' checksums,
// by which ExrSource tells whether they are the same (tables have their own).
std::string write_exr_parts(const E57Source& source, const std::filesystem::path& folder);

// Its one scan, by the header; with all that read_e57() would tell of the E57 file.
ScanEntry list_exr_records(const std::filesystem::path& file);
Scan read_exr_records(const std::filesystem::path& file, const ReadOptions& options = {});
// The same as E57Stream.
std::unique_ptr<ScanStream> stream_exr_records(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
