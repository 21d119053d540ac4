#pragma once
#include "write/scan_stream.hpp"

namespace synth {

// The truth of a scan whose file lists its samples: see open_truth_file().
class TruthFile : public ScanFile {
 public:
  TruthFile(const std::filesystem::path&, int rows_of_grid);  // 0 rows: returns only
  ~TruthFile() override;
  void add(const std::vector<Sample>& column) override;
  void finish() override;

 private:
  struct Spill;
  std::filesystem::path path_;
  int rows_;
  std::unique_ptr<Spill> spill_;
};

}  // namespace synth
