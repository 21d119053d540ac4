#include "io/read_scan.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/error.hpp"
#include "io/e57/e57.hpp"
#include "io/e57/e57_stream.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/exr/exr_scan.hpp"
#include "io/foreign_files.hpp"
#include "io/las/las.hpp"
#include "io/output.hpp"
#include "io/pcd/pcd.hpp"
#include "io/ply/ply.hpp"
#include "io/samples/sample_file.hpp"
#include "io/stream_scan.hpp"
#include "io/text/pts.hpp"
#include "io/text/ptx.hpp"
#include "io/text/text_cursor.hpp"
#include "io/text/xyz.hpp"

namespace hybrid::io {
namespace {

// One format per row; a new one is one row more.
struct ScanFormat {
  const char* extension;
  std::vector<ScanEntry> (*list)(const std::filesystem::path& file, const ReadOptions& options);
  Scan (*read)(const std::filesystem::path& file, const ScanEntry& entry);
  // Null also where this one cannot be streamed.
  std::unique_ptr<ScanStream> (*stream)(const std::filesystem::path& file, const ScanEntry& entry) = nullptr;
  bool tells = true;  // a file of this extension is a scan: who walks folders takes it
};

std::vector<ScanEntry> list_exr(const std::filesystem::path& file, const ReadOptions& options) {
  check_readable(file);
  if (holds_exr_records(file)) return {list_exr_records(file)};
  return {list_exr_scan(file, options)};
}

Scan read_exr(const std::filesystem::path& file, const ScanEntry& entry) {
  return holds_exr_records(file) ? read_exr_records(file, {.salvage = entry.salvage, .exact = entry.exact})
                                 : read_exr_scan(file, {.salvage = entry.salvage});
}

std::unique_ptr<ScanStream> stream_exr(const std::filesystem::path& file, const ScanEntry& entry) {
  return holds_exr_records(file) ? stream_exr_records(file, entry) : nullptr;
}

std::vector<ScanEntry> list_e57(const std::filesystem::path& file, const ReadOptions& options) {
  const E57File opened(file, {.salvage = options.salvage});
  const E57Contents& contents = opened.contents();
  std::vector<ScanEntry> entries;
  for (std::size_t i = 0; i < contents.scans.size(); ++i) {
    ScanEntry entry;
    entry.name = file.stem().string();
    if (contents.scans.size() > 1) entry.name += fmt::format("-{}", i);
    entry.samples = contents.scans[i].points.count;
    for (const E57Field& field : contents.scans[i].points.fields)
      entry.structure += (entry.structure.empty() ? "" : " ") + field.name;
    entry.crs = contents.coordinate_system;
    entry.unit = std::string("m");
    entry.index = i;
    entries.push_back(std::move(entry));
  }
  if (entries.empty())
    fail_input(
        "{}: expected scans, found none (no element data3D, or an empty one); export it with its points",
        file.string());
  return entries;
}

Scan read_e57_entry(const std::filesystem::path& file, const ScanEntry& entry) {
  return read_e57(E57File(file, {.salvage = entry.salvage}), entry.index, entry.exact);
}

std::vector<ScanEntry> list_ply_entry(const std::filesystem::path& file, const ReadOptions&) {
  return list_ply(file);
}

// Of a file with one scan.
template <Scan (*read)(const std::filesystem::path&, const ReadOptions&)>
Scan read_one(const std::filesystem::path& file, const ScanEntry& entry) {
  return read(file, {.salvage = entry.salvage, .exact = entry.exact});
}

constexpr ScanFormat kScanFormats[] = {
    {".e57", list_e57, read_e57_entry, E57Stream::open},
    {".pcd", list_pcd, read_one<read_pcd>, stream_pcd},
    {".ply", list_ply_entry, read_one<read_ply>, stream_ply},
    {".ptx", list_ptx, read_ptx, stream_ptx},
    {".pts", list_pts, read_pts, stream_pts},
    {".las", list_las, read_las, stream_las},
    {".exr", list_exr, read_exr, stream_exr},
    {".hsf", list_sample_file, read_one<read_sample_file>, stream_sample_file},
    {".xyz", list_xyz, read_xyz, stream_xyz},
    {".asc", list_xyz, read_xyz, stream_xyz, false},
    {".csv", list_xyz, read_xyz, stream_xyz, false},
    {".txt", list_xyz, read_xyz, stream_xyz, false},
};

// Refused (advice_on() says what to do), but a scan: who walks folders tells of it.
constexpr std::string_view kRefused = ".laz";

bool is_format(std::string_view extension) {
  return std::any_of(std::begin(kScanFormats), std::end(kScanFormats),
                     [&](const ScanFormat& format) { return extension == format.extension; });
}

const ScanFormat& format_of(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  for (const ScanFormat& format : kScanFormats) {
    if (extension != format.extension) continue;
    if (const auto meant = extension_by_content(file); !meant.empty() && meant != extension)
      fail_input("{}: expected a {} file, found the first bytes of a {} file; {}", file.string(), extension,
                 meant, is_format(meant) ? "correct its extension" : advice_on(meant));
    return format;
  }
  check_readable(file);
  std::string remedy = advice_on(extension);
  // A packed LAS file begins as any other does.
  if (const auto meant = extension_by_content(file); extension != kRefused && is_format(meant))
    remedy = fmt::format("its first bytes are those of a {} file: name it so", meant);
  fail_input("{}: expected a scan as {}, found {}; {}", file.string(), scan_extensions(),
             extension.empty() ? "no extension" : extension, remedy);
}

}  // namespace

std::vector<ScanEntry> list_scans(const std::filesystem::path& file, const ReadOptions& options) {
  auto entries = format_of(file).list(file, options);
  for (ScanEntry& entry : entries) {
    entry.salvage = options.salvage;
    entry.exact = options.exact;
  }
  return entries;
}

Scan read_scan(const std::filesystem::path& file, const ScanEntry& entry) {
  if (!entry.problem.empty()) throw Error(ErrorKind::input, entry.problem);
  return format_of(file).read(file, entry);
}

std::unique_ptr<ScanStream> stream_scan(const std::filesystem::path& file, const ScanEntry& entry) {
  if (!entry.problem.empty()) throw Error(ErrorKind::input, entry.problem);
  const ScanFormat& format = format_of(file);
  auto stream = format.stream ? format.stream(file, entry) : nullptr;
  if (!stream) stream = std::make_unique<ScanInMemory>(format.read(file, entry));
  return stream;
}

Scan read_scan(const std::filesystem::path& file, std::size_t index) {
  return read_scan(file, scan_at(file, list_scans(file), index));
}

const ScanEntry& scan_at(const std::filesystem::path& file, const std::vector<ScanEntry>& entries,
                         std::size_t index) {
  if (index >= entries.size())
    fail_input("{}: index {}: the file holds {} scans (0-based)", file.string(), index, entries.size());
  return entries[index];
}

std::optional<GridScan> read_grid_scan(const std::filesystem::path& file, const ScanEntry& entry) {
  if (!entry.problem.empty() || entry.salvage) return {};
  const std::string extension = lower_case(file.extension().string());
  if (extension == ".e57") return read_e57_grid(E57File(file), entry.index);
  if (extension == ".exr" && !holds_exr_records(file)) return read_exr_grid(file);
  return {};
}

bool has_scan_extension(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return extension == kRefused ||
         std::any_of(std::begin(kScanFormats), std::end(kScanFormats),
                     [&](const ScanFormat& format) { return format.tells && extension == format.extension; });
}

std::string scan_extensions() {
  std::string text;
  for (std::size_t i = 0; i < std::size(kScanFormats); ++i)
    text += (i == 0                            ? ""
             : i + 1 < std::size(kScanFormats) ? ", "
                                               : " or ") +
            std::string(kScanFormats[i].extension);
  return text;
}

}  // namespace hybrid::io
