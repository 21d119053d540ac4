#pragma once
#include <filesystem>
#include <memory>

#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// One scan as read_scan() reads it, with samples that come from the file in blocks: of E57 files and range
// images made from one, LAS and sample files; not in salvage of PTX, PTS, PLY and PCD. The others come from
// memory. All is read once here: throws what read_scan() throws.
std::unique_ptr<ScanStream> stream_scan(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
