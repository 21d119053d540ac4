#include "fuzz/targets.hpp"

namespace hybrid::testing {

std::vector<FuzzTarget> fuzz_targets() {
  std::vector<FuzzTarget> targets = e57_fuzz_targets();
  for (const auto& part : {scan_fuzz_targets(), other_fuzz_targets()})
    targets.insert(targets.end(), part.begin(), part.end());
  return targets;
}

FuzzRun::FuzzRun(const FuzzTarget& target, const std::filesystem::path& folder)
    : target_(target), path_(folder / target.file) {
  std::filesystem::create_directories(folder);
  target.seeds(folder);
  if (!target.file.empty()) file_ = std::make_unique<FileInMemory>(path_);
}

void FuzzRun::operator()(std::string_view bytes) const {
  if (file_) file_->write(bytes);
  target_.run(path_, bytes);
}

}  // namespace hybrid::testing
