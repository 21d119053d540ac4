#pragma once
#include <cstdint>
#include <vector>

#include "score/measure/true_mesh.hpp"
#include "score/read/view_result.hpp"

namespace score {

// Which photographs the pixels were painted with, against who truly sees the surface there. A pixel is judged
// by its centre and, before it is blamed, by its four corners: at an outline half a pixel decides what it
// shows.
struct BleedingScore {
  std::int64_t pixels = 0, painted = 0;  // painted: with a photograph
  std::int64_t bleeding = 0;             // painted with one that truly sees none of the pixel's five points
  std::int64_t bleeding_elsewhere = 0;   // of these: the drawn surface is not the true one (kDrawnOffM)
  std::int64_t bleeding_at_centre = 0;   // the same by the centre alone
  std::int64_t red = 0;                  // a surface no photograph is said to see
  std::int64_t red_though_seen = 0;      // red, while one photograph truly sees all five points
  std::int64_t truly_unseen = 0;         // no photograph sees the centre: what a perfect result leaves red
};

// A drawn surface this far, and this share of its distance, from the true one is another one.
inline constexpr double kDrawnOffM = 0.03, kDrawnOffShare = 0.005;

// `usable`: photographs the view may use, by index.
BleedingScore score_bleeding(const ViewResult& view, const Camera& camera,
                             const std::vector<Camera>& photographs, const std::vector<std::uint8_t>& usable,
                             const TrueMesh& mesh);

}  // namespace score
