#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "score/read/model_files.hpp"
#include "score/read/scene_truth.hpp"

namespace score {

// Areas are counted on a grid of kOpeningStepM. A polygon closes a point of a face when it lies within
// kFaceReachM of it, is within 30 degrees of parallel to it, and covers its foot.
struct OpeningScore {
  struct One {
    std::string name, face;
    double area_m2 = 0;
    std::optional<double> open_share;      // that no polygon of model/edited.obj closes
    std::optional<double> reported_share;  // that a ring of model/openings.json covers
    // Lines of sight across it (opening_rays.hpp), and how far apart they are on it; of scans with range.exr.
    std::optional<std::int64_t> rays;
    std::optional<double> spacing_m;
    // From places on its border to the nearest reported ring's, of 100 the farthest but five; where it is
    // reported by half.
    std::optional<double> border_m;

    // What the border may be off: 3 cm, or two spacings of the scan that sees it best.
    std::optional<double> border_bound_m() const;
  };
  std::vector<One> openings;
  std::optional<double> wrongly_open_m2;      // closed in the scene's own proxy, outside every true opening
  std::optional<double> wrongly_reported_m2;  // reported outside every true opening
  std::optional<int> false_openings;          // reported rings most of whose area is
};
inline constexpr std::int64_t kCountedRays = 500;

// Of the openings that at least kCountedRays lines of sight cross: those reported by half, and those whose
// border is also within its bound.
struct OpeningTally {
  int openings = 0, found = 0, within_bound = 0;
};
OpeningTally tally(const OpeningScore& score);

inline constexpr double kOpeningStepM = 0.02;
inline constexpr double kFaceReachM = 0.15;

Plane plane_of_ring(const Ring& ring);

// `proxy`: the scene's model before editing; empty when it is not there.
OpeningScore score_openings(const std::vector<TrueOpening>& truth, const EditedModel& result,
                            const std::vector<Ring>& proxy);

}  // namespace score
