#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/planes/square_planes.hpp"

namespace hybrid::testing {

// A room that every plane stage meets: a box with a column (a vertical cylinder) from floor to ceiling, a
// panel on one wall (a parallel step), a niche in another one, and range noise. The scanner stands at the
// origin of the scan frame.
struct BoxRoom {
  int rows = 300, cols = 720;
  double lowest_deg = -60, highest_deg = 89.75;
  bool full_turn = true;           // else 100 degrees of azimuth around -y, where the niche is
  double noise_m = 0.002;          // standard deviation along the ray
  double jitter = 0;               // directions stray from the grid by up to this many steps
  double dropouts = 0;             // share of samples without return
  double column_radius_m = 0.25;   // 0 = no column
  double panel_m = 0.03;           // how far the panel stands out of the wall; 0 = none
  double panel_gap_m = 0;          // cuts the panel in two: one sees the wall between its halves
  double niche_m = 0.4;            // depth; 0 = none
  Mat3 turned = Mat3::Identity();  // room_from_scan: how the scanner stands; its grid turns with it
  bool occluder = false;           // a post in front of the +y wall that cuts it in two
  std::uint32_t seed = 1;
};

// Truth labels.
enum RoomPlane : std::uint8_t {
  kNothing,
  kFloor,
  kCeiling,
  kWallEast,
  kWallWest,
  kWallNorth,
  kWallSouth,
  kPanel,
  kNicheBack,
  kColumn,      // curved
  kSmallFaces,  // edges of panel, jambs of the niche, post: planar but not scored
};
inline constexpr int kScoredPlanes = 8;

struct RoomScan {
  RangeImage image;
  std::vector<std::uint8_t> truth;  // RoomPlane per node
};
RoomScan scan_room(const BoxRoom& room);

struct RoomScore {
  double right = 0;          // share of scored planar samples with their supercluster's majority label
  double curved_planar = 0;  // share of the column's samples with any label
  std::vector<std::size_t> majority;  // truth per supercluster
  int found = 0;                      // planes with at least half of their samples right
};
RoomScore score_room(const RoomScan& scan, const PlaneSegmentation& segmentation);

// Squares as METHOD 2 makes them, in double precision with Eigen: RANSAC, refit on the inliers.
stages::SquarePlanes fit_squares(const RangeImage& image, int square, double sigma_m);

}  // namespace hybrid::testing
