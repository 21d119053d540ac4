#pragma once
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

struct ContourOptions {
  int tile = 1024;
};

// METHOD 4: marching squares over each supercluster's mask in (azimuth, elevation), every contour point
// snapped to the nearest member sample (nanoflann), then that sample's ray intersected with the
// supercluster's plane. Fills segmentation.superclusters[].contours with closed rings without
// self-intersections. Returns, per sample, 1 where the sample is a boundary sample of its supercluster.
// Kernel: contour_cells.
std::vector<std::uint8_t> trace_contours(device::Queue& queue, const RangeImage& image,
                                         PlaneSegmentation& segmentation, const ContourOptions& options = {});

}  // namespace hybrid::stages
