#pragma once
#include <cstdint>
#include <vector>

#include "geometry/cylinder.hpp"
#include "geometry/plane.hpp"

namespace hybrid {

// Closed boundary of a supercluster on its plane, scan frame, metres; first point not repeated at the end.
// Outer rings run counter-clockwise seen from the side the normal points to, inner rings (holes) clockwise.
struct ContourRing {
  std::vector<Vec3> points;
  bool outer = true;
};

// A scene-scale plane: connected, locally planar squares of one orientation (METHOD 3).
struct Supercluster {
  std::uint32_t id = 0;  // from 1; 0 in label images = no supercluster
  Plane plane;           // scan frame, normal towards the scanner
  Vec3 centroid_m = Vec3::Zero();
  double rms_m = 0;    // of the member samples' orthogonal distances
  double area_m2 = 0;  // summed from the member samples' solid angles
  int squares = 0;
  std::int64_t samples = 0;  // measured member samples
  std::vector<ContourRing> contours;
};

// What a square became: the class image of the paper's figure 2(b).
enum SquareClass : std::uint8_t {
  kUndersampled = 0,
  kNonPlanar = 1,
  kPlanarTooSmall = 2,
  kSuperclusterMember = 3
};

// All planes of one range image.
struct PlaneSegmentation {
  int square = 5;          // side in samples
  double waviness_m = 0;   // how far samples may stray from their plane, beyond the noise
  double interleaved = 0;  // share of the labelled samples that lie between those of a parallel plane
  int square_rows = 0, square_cols = 0;
  std::vector<std::uint8_t> square_class;   // SquareClass, square_rows x square_cols
  std::vector<std::uint32_t> square_label;  // supercluster id per square, 0 = none
  std::vector<std::uint32_t>
      sample_label;  // supercluster id per sample (inliers of its plane only), 0 = none
  std::vector<Supercluster> superclusters;  // [id - 1]
  std::vector<Cylinder> cylinders;          // [id - 1]; of samples with label 0
};

}  // namespace hybrid
