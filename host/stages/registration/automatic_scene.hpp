#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/registration/face_planes.hpp"

namespace hybrid::stages {

// What the automatic alignment (METHOD 7) looks at on either side, in numbers small enough to try many poses.

// Superclusters of one plane taken together, scan frame: a wall that an occluder cuts in pieces counts once.
struct ScanPlane {
  Plane plane;  // normal towards the scanner
  Vec3 centroid = Vec3::Zero();
  double area_m2 = 0;
};

// A piece of at most about 2 m of a scan plane, with the moments of its samples about its centroid: sums over
// tiles are sums over all samples (FINDINGS.md).
struct PlaneTile {
  std::uint32_t plane = 0;         // index of the scan plane
  std::uint32_t supercluster = 0;  // index: id - 1
  Vec3 normal;                     // of its supercluster
  double area_m2 = 0;
  Vec3 centroid = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();  // sum of area (p - centroid)(p - centroid)^T
};

// A planar sample as a line of sight from the scanner.
struct SightRay {
  Vec3 direction;  // unit
  double range_m = 0;
  Vec3 normal;
  double area_m2 = 0;
  std::uint32_t plane = 0;  // index of the scan plane
  bool spans = false;       // the plane is floor or ceiling or reaches from one to the other: no furniture
};

struct ScanEvidence {
  std::vector<ScanPlane> planes;  // largest first
  std::vector<PlaneTile> tiles;
  std::vector<SightRay> rays;
  double area_m2 = 0;  // of all planar samples
  double reach_m = 0;  // rms distance of the planar samples from the scanner
};

// From the samples of superclusters, chosen by area (choose_planar_samples): the same for any thread count.
ScanEvidence gather_evidence(const RangeImage& image, const PlaneSegmentation& segmentation, int rays,
                             int seed);

// The evidence as a scanner turned by `turned_from_scan` would have it (tests and trials).
ScanEvidence turned(const ScanEvidence& evidence, const Eigen::Quaterniond& turned_from_scan);

// A face in coordinates of its own plane.
struct FaceShape {
  Plane plane;
  double area_m2 = 0;
  Vec3 origin, u, v;
  std::vector<std::vector<Vec2>> rings;
  Eigen::AlignedBox2d box;  // of the outer ring
  // Some sides that follow each other, through path[first] to path[last], with their box: outlines of scans'
  // superclusters have hundreds of sides, most of them far from a point.
  struct Chain {
    std::size_t first, last;
    Eigen::AlignedBox2d box;
  };
  std::vector<Vec2> path;  // the rings, each with its first corner again at its end
  std::vector<Chain> chains;
  std::uint32_t face = 0;         // index in the model
  std::uint32_t plane_index = 0;  // index of the model plane

  // How far the point's foot on the plane lies outside the polygon (0 inside), world scale; beyond `most_m`
  // infinity, or as far.
  double outside_m(const Vec3& point, double most_m = std::numeric_limits<double>::infinity()) const {
    const Vec2 foot(u.dot(point - origin), v.dot(point - origin));
    constexpr double kRoundedUp = 1 + 1e-9;
    if (box.squaredExteriorDistance(foot) > most_m * most_m * kRoundedUp)
      return std::numeric_limits<double>::infinity();
    return outside_rings_m(foot, most_m);
  }

 private:
  double outside_rings_m(const Vec2& foot, double most_m) const;
  bool is_inside(const Vec2& foot) const;
};

// Faces of one plane taken together.
struct ModelPlane {
  Plane plane;
  double area_m2 = 0;
};

struct ModelShapes {
  std::vector<FaceShape> faces;    // largest first, at most kMostFaces
  FacePlanes face_planes;          // theirs
  std::vector<ModelPlane> planes;  // largest first
  Eigen::AlignedBox3d box;
  double area_m2 = 0;  // of all faces
  std::size_t all_faces = 0;
  double kept_area_m2 = 0;  // of `faces`
  // The faces that are kept stand for the model. Else it is a mesh of faces too small to be planes.
  bool has_large_faces() const { return kept_area_m2 >= 0.7 * area_m2; }
};

// Faces beyond this many, the smallest, are only seen by rays: a mesh of small triangles has no planes to
// match.
inline constexpr std::size_t kMostFaces = 512;

// Throws ErrorKind::input: no faces, a vertex that is not finite, a face without area (named).
ModelShapes measure_model(const PolygonModel& model);

}  // namespace hybrid::stages
