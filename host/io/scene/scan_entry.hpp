#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace hybrid::io {

struct ReadOptions {
  // Of damaged files use what is good, and say in the scan's notes what is lost, instead of failing.
  bool salvage = false;
  // Also the coordinates that float would round (Scan::exact): 24 more bytes per sample.
  bool exact = false;
};

// One scan of a file, as its headers tell it.
struct ScanEntry {
  std::string name{};
  std::uint64_t samples = 0;         // 0 also where the headers do not tell (EXR)
  int grid_rows = 0, grid_cols = 0;  // 0: not organised
  std::string structure{};           // for people: "LAS 1.2, point format 3", "x y z intensity"
  std::string crs{};                 // as in Scan
  std::string unit{};                // of coordinates, where the format or the file says; else ""
  std::string problem{};             // why it cannot be read, or ""
  // For its reader.
  bool salvage = false, exact = false;       // ReadOptions
  std::size_t index = 0;                     // in the file
  std::uint64_t offset = 0, line = 1;        // where it starts
  std::uint64_t end = 0;                     // where it ends
  std::optional<std::uint64_t> announced{};  // in salvage: samples that its header counts, where it does
  std::size_t kept_bytes = 256 << 20;        // of samples that may stay in memory when it is streamed
};

}  // namespace hybrid::io
