#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "score/read/view_result.hpp"

namespace score {

// METHOD, how results are scored: on the pixels of the mask, after one gain per channel (least squares in
// linear light).
struct PictureQuality {
  std::int64_t compared = 0;  // pixels of the mask
  std::array<double, 3> gain{1, 1, 1};
  double psnr_db =
      0;  // sRGB-encoded 0..255, squared error pooled over R, G and B; kBestPsnrDb for equal pictures
  double ssim = 0;  // luma, Gaussian window 11 x 11 of sigma 1.5 (Wang et al. 2004), mean over the mask
  // High band: luma minus its Gaussian of kSharpnessSigmaPx, windows over the mask only.
  double sharpness = 0;         // root of its energy over the truth's: below 1 blurred, above 1 false detail
  double detail_agreement = 0;  // its correlation with the truth's: false detail does not raise it
};
inline constexpr double kBestPsnrDb = 100;
inline constexpr double kSharpnessSigmaPx = 1.5;

PictureQuality compare_pictures(const Picture& linear, const Picture& srgb_truth,
                                const std::vector<std::uint8_t>& mask);

}  // namespace score
