#pragma once
#include <filesystem>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// The scans of a file, whose format follows from its extension (in any case; scan_extensions()), by their
// headers; samples are not read, in text only counted. Throws ErrorKind::input naming the file, the place
// (line or byte), what was expected, what was found and the remedy. An entry with a `problem` stands for a
// scan that is there and cannot be read, while the others can.
std::vector<ScanEntry> list_scans(const std::filesystem::path& file, const ReadOptions& options = {});

// One scan, without the others; the entry comes from list_scans of this file. Throws as list_scans does, and
// the entry's problem. Allocates nothing before the header's counts are checked against the file's size.
Scan read_scan(const std::filesystem::path& file, const ScanEntry& entry);
// The same by its number, from 0.
Scan read_scan(const std::filesystem::path& file, std::size_t index);
// Entries[index] of a file, or the error that it has no such scan.
const ScanEntry& scan_at(const std::filesystem::path& file, const std::vector<ScanEntry>& entries,
                         std::size_t index);

// Whether the extension is that of a format above (in any case), or of one that is known and cannot be read.
bool has_scan_extension(const std::filesystem::path& file);
// ".pcd, .ply, .ptx ... or .exr", for messages and help.
std::string scan_extensions();

}  // namespace hybrid::io
