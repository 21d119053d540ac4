#pragma once
#include <filesystem>
#include <vector>

#include "io/read_scan.hpp"

namespace hybrid::testing {

// Every scan of a file at once.
inline std::vector<Scan> read_scans(const std::filesystem::path& file) {
  std::vector<Scan> scans;
  for (const io::ScanEntry& entry : io::list_scans(file)) scans.push_back(io::read_scan(file, entry));
  return scans;
}

}  // namespace hybrid::testing
