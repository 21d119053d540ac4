#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_in_memory.hpp"

namespace hybrid::testing {

// What is fuzzed: a reader given any bytes, strictly and with salvage. It reads or throws Error of
// ErrorKind::input, and what it gives keeps the promises of geometry/scan.hpp; anything else is a finding,
// which is another exception here. The fuzzer (fuzz.cpp) and the replay of the corpus run the same targets.
struct FuzzTarget {
  std::string name{};          // and the folder of its corpus
  std::filesystem::path file;  // that it reads, in a folder of its own; empty: it takes the bytes themselves
  std::size_t most_bytes;      // of an input: small ones run fast and reach the same code
  // Inputs to start from; writes the files that must lie beside.
  std::function<std::vector<std::string>(const std::filesystem::path& folder)> seeds;
  std::function<void(const std::filesystem::path& file, std::string_view bytes)> run;
  bool pages = false;  // E57: mutations are followed by new checksums and lengths
};

std::vector<FuzzTarget> fuzz_targets();
// By kind; a new format is one row more.
std::vector<FuzzTarget> scan_fuzz_targets();
std::vector<FuzzTarget> e57_fuzz_targets();
std::vector<FuzzTarget> other_fuzz_targets();  // the rows of io/reader_table.hpp that are no scans

// One target and the file in memory it reads.
class FuzzRun {
 public:
  // `folder` is where its files go, made when it is missing.
  FuzzRun(const FuzzTarget& target, const std::filesystem::path& folder);
  void operator()(std::string_view bytes) const;

 private:
  const FuzzTarget& target_;
  std::filesystem::path path_;
  std::unique_ptr<FileInMemory> file_;
};

}  // namespace hybrid::testing
