#pragma once
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

struct ContourOptions {
  int least_patch = 25;      // specks and holes of fewer samples do not shape contours
  int least_ring = 8;        // rings of fewer samples are dropped (their samples stay boundary samples)
  double min_cosine = 0.02;  // c: samples whose ray meets the plane at |n.u| < c are no contour points
  int tile = 1024;
};

// METHOD 4: marching squares over each supercluster's mask in (azimuth, elevation), every contour point
// snapped to the nearest member sample (nanoflann), then that sample's ray intersected with the
// supercluster's plane. Fills segmentation.superclusters[].contours with closed rings without
// self-intersections, the largest first. The mask is the sample labels without specks and small holes
// (clean_labels), so that dropouts make no rings. Parts one sample wide have no inside: they get no ring.
// Rings that noise makes cross are repaired as make_simple says. A supercluster across the azimuth seam gets
// one closed ring; masks end at the border of an image that does not wrap.
// Returns, per sample, 1 where the sample is a boundary sample of its supercluster: contour points were
// snapped to it, or no contour encloses it (specks). Kernel: contour_cells.
std::vector<std::uint8_t> trace_contours(device::Queue& queue, const RangeImage& image,
                                         PlaneSegmentation& segmentation, const ContourOptions& options = {});

}  // namespace hybrid::stages
