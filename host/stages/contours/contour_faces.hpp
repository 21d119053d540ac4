#pragma once
#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/intersections.hpp"
#include "stages/planes/decimate.hpp"

namespace hybrid::stages {

// When a supercluster's contour stands for its samples.
struct ContourFaceOptions {
  double unexplained_share = 0.9;  // of its samples, at least: else the polygon would lie on a proxy face
  double coverage = 0.5;           // of its samples inside the polygon, at least; the others stay samples
  double seen_through = 0.03;      // of the rays that meet the polygon, at most, return from behind it
  double behind_sigmas = 4;        // a sample this far behind the plane, along its ray, was seen through it
  double straighten = 0.75;        // vertices this near the line of their neighbours go, in sample spacings
  double border_rms = 0.36;  // steps of its outermost samples from a straight border: 0.29 without noise
  double border_most = 1;    // steps of each of them
  double widen = 0.5;        // steps of the scan's grid from its outermost samples to the plane's end
};

// One supercluster that no proxy face explains, and the evidence.
struct ContourFit {
  std::uint32_t supercluster = 0;  // id
  double unexplained_share = 0;    // of its measured samples
  double coverage = 0;             // share of its measured samples the polygon covers
  double seen_through = 0;         // share of the rays through the polygon that return from behind it
  bool polygon = false;            // it became one; else its samples stay
};

struct ContourFaces {
  PolygonModel model;                       // scan frame; one face per outer ring, with its holes
  std::vector<std::uint32_t> supercluster;  // per face: id
  std::vector<ContourFit> fits;             // by id
  std::vector<std::uint8_t> covered;        // per node: 1 = sample of a supercluster, inside its polygon or
                                            // beside it: the polygon stands for it
};

// METHOD 4 and 10: superclusters that no proxy face explains (door leaves, recesses, jambs) as their contour
// polygons, where the polygon is faithful; the others keep their samples, so that nothing becomes a hole.
// `explained`: per node, as for keep_unexplained. `stray` (per node, stages::Stray) is no evidence of being
// seen through. `sigma_m`: range noise. Vertices are dropped where the ring stays simple without them. What
// is covered and seen through is asked of the contours, whose vertices are samples; the polygons have
// straight borders where those are (with_border_lines) and are wider (widened_rings, which is given
// `intersections`). A polygon that can be triangulated in the scan's frame and not in the world's, where
// rounding is another, is none. Throws ErrorKind::failed when the vectors are not the image's.
ContourFaces unexplained_contours(const RangeImage& image, const PlaneSegmentation& segmentation,
                                  const std::vector<Intersection>& intersections,
                                  const std::vector<std::uint8_t>& explained,
                                  const std::vector<std::uint8_t>& stray, double sigma_m,
                                  const ContourFaceOptions& options = {}, const Pose& world_from_scan = {});

// Discards the planar interiors that a contour polygon stands for (kUnexplained where covered).
void discard_covered(const std::vector<std::uint8_t>& covered, Decimation& decimation);

}  // namespace hybrid::stages
