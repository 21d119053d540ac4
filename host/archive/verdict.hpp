#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "io/scene/threshold_file.hpp"

namespace hybrid::archive {

enum class Verdict {
  better,
  moved,  // and nobody says which way is worse, or by less than the threshold
  worse,  // by more than the threshold: a regression
};
const char* name_of(Verdict verdict);

// What is thought of a figure that moved, by the file's entries and then the built-in ones, the first that
// matches: residuals, errors, what is called planar or left red, failures should not grow; right samples,
// planes found, overlap, PSNR, SSIM, what is seen and discarded should not shrink. A status that was
// "accepted" and is no more is worse. Values: numbers, texts, or null (not there).
Verdict judge(const io::ThresholdFile& thresholds, const std::string& figure,
              const nlohmann::ordered_json& before, const nlohmann::ordered_json& after);

// The built-in entries.
const std::vector<io::Threshold>& default_thresholds();

}  // namespace hybrid::archive
