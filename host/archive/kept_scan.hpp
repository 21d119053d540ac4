#pragma once
#include <filesystem>
#include <string>

#include "batch/scan_unit.hpp"

namespace hybrid::archive {

// kept.bin: all that registration, rendering and writing need of a scan, bit for bit, so that a scene goes on
// from it as if it had just been made. About 18 bytes per sample with intensity; a georeferenced scan is kept
// whole, too. Throws as io::write_atomically does.
void write_kept_scan(const std::filesystem::path& file, batch::ProcessedScan& scan);

// Throws ErrorKind::input naming the file and the byte when it is damaged.
batch::ProcessedScan read_kept_scan(const std::filesystem::path& file);

}  // namespace hybrid::archive
