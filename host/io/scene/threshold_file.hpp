#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid::io {

// When a figure that moved got worse, as a TOML file says it:
//
//   defaults = true                    optional: the built-in ones apply where no entry here matches
//   [[figure]]
//   name = "registration/icp_rms_m"    as `batch diff` prints it; * and ? as in a shell
//   worse = "higher"                   or "lower"; "never": this figure may do what it likes
//   absolute = 0.0002                  worse by more than the larger of the two; both default to 0
//   relative = 0.05                    of its value before
struct Threshold {
  enum class Worse { higher, lower, never };
  std::string name;
  Worse worse = Worse::higher;
  double absolute = 0, relative = 0;
};
struct ThresholdFile {
  bool defaults = true;
  std::vector<Threshold> figures;  // the first that matches a figure counts
};

// Throws ErrorKind::input naming file, line and key.
ThresholdFile read_threshold_file(const std::filesystem::path& file);

}  // namespace hybrid::io
