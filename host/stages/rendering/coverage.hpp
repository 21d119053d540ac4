#pragma once
#include <string>
#include <vector>

#include "stages/rendering/render.hpp"

namespace hybrid::stages {

struct CoverageOptions {
  double coverage_texel_m = 0;  // of what is sampled on the faces; 0: a million texels, 2 cm at the finest
  int next_cameras = 6;         // positions suggested; 0: none
  double next_camera_height_m = 3;  // how high above the ground they stand at most
};
const std::vector<OptionRow<CoverageOptions>>& coverage_option_table();

// What no photograph sees of one proxy face.
struct FaceCoverage {
  std::size_t face = 0;
  double area_m2 = 0, unseen_m2 = 0;
};

// A camera that would see more of it.
struct NextCamera {
  Vec3 position = Vec3::Zero(), direction = Vec3::UnitY();
  double gained_m2 = 0;  // seen by no photograph and none of the cameras before it in the list
};

struct Coverage {
  double texel_m = 0;
  std::vector<FaceCoverage> faces;
  double area_m2 = 0, unseen_m2 = 0;
  std::vector<NextCamera> next;
  std::string next_camera;  // the photograph whose camera (size, focal length, lens) they are for
};

// "Red means unseen" (paper figure 6), in square metres: the front of every face is sampled in a grid and
// asked of all photographs, with proxy and scans in the way. Then cameras like the scene's, chosen one by one
// for what they add (greedy), a face's area counting the less the more of it the others show
// (kFaceSaturation), so that they spread over all that is red; the list has those that add most area first.
// Candidates stand before the unseen places at several distances and angles, no higher above the ground below
// them than a person with a pole reaches, in free space that a scanner or a photograph has seen
// (in_free_space); places that they see under more than 75 degrees do not count. The same for any number of
// threads.
Coverage measure_coverage(Renderer& renderer, const RenderScene& scene, const CoverageOptions& options);

}  // namespace hybrid::stages
