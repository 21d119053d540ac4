#pragma once
#include <filesystem>
#include <string>

#include "batch/scene_scan.hpp"

namespace hybrid::archive {

// kept.bin: all that registration, rendering and writing need of a scan, bit for bit, so that a scene goes on
// from it as if it had just been made. About 8 bytes per sample of a range image with intensity; a
// georeferenced scan is kept whole beside it. Throws as io::write_atomically does.
void write_kept_scan(const std::filesystem::path& file, batch::KeptScan& scan);

// Throws ErrorKind::input naming the file and the byte when it is damaged.
batch::KeptScan read_kept_scan(const std::filesystem::path& file);

}  // namespace hybrid::archive
