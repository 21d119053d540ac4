#include "archive/verdict.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>

namespace hybrid::archive {
namespace {

using Worse = io::Threshold::Worse;

const io::Threshold* find(const std::vector<io::Threshold>& list, const std::string& figure) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const io::Threshold& one) {
    return fnmatch(one.name.c_str(), figure.c_str(), 0) == 0;
  });
  return found == list.end() ? nullptr : &*found;
}

}  // namespace

const char* name_of(Verdict verdict) {
  return verdict == Verdict::better ? "better" : verdict == Verdict::worse ? "worse" : "moved";
}

const std::vector<io::Threshold>& default_thresholds() {
  static const std::vector<io::Threshold> kDefaults = {
      {"failures", Worse::higher, 0, 0},
      {"registration/icp_rms_m", Worse::higher, 0.0002, 0.05},
      {"registration/residuals/median_m", Worse::higher, 0.0002, 0.05},
      {"registration/residuals/p95_m", Worse::higher, 0.001, 0.05},
      {"registration/overlap", Worse::lower, 0.005, 0},
      {"registration/wall_after_icp/within_*", Worse::lower, 0.005, 0},
      {"registration/icp_converged", Worse::lower, 0.5, 0},
      {"truth/pose_error_mm", Worse::higher, 0.05, 0.1},
      {"truth/pose_error_deg", Worse::higher, 0.001, 0.1},
      {"truth/planar_samples_right_share", Worse::lower, 0.002, 0},
      {"truth/planes_found", Worse::lower, 0, 0},
      {"truth/curved_called_planar_share", Worse::higher, 0.005, 0},
      {"decimation/discarded_share", Worse::lower, 0.01, 0},
      {"*psnr_db", Worse::lower, 0.1, 0},
      {"*ssim", Worse::lower, 0.002, 0},
      {"*share_seen", Worse::lower, 0.005, 0},
      {"red_share", Worse::higher, 0.005, 0},
  };
  return kDefaults;
}

Verdict judge(const io::ThresholdFile& thresholds, const std::string& figure,
              const nlohmann::ordered_json& before, const nlohmann::ordered_json& after) {
  const io::Threshold* threshold = find(thresholds.figures, figure);
  if (!threshold && thresholds.defaults) threshold = find(default_thresholds(), figure);
  if (threshold && threshold->worse == Worse::never) return Verdict::moved;
  if (figure == "registration/status") {
    if (before == "accepted") return Verdict::worse;
    return after == "accepted" ? Verdict::better : Verdict::moved;
  }
  if (!threshold || !before.is_number() || !after.is_number()) return Verdict::moved;
  const double a = before.get<double>(), b = after.get<double>();
  const double worse_by = threshold->worse == Worse::higher ? b - a : a - b;
  if (worse_by > std::max(threshold->absolute, threshold->relative * std::abs(a))) return Verdict::worse;
  return worse_by < 0 ? Verdict::better : Verdict::moved;
}

}  // namespace hybrid::archive
