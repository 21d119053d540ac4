#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device/queue.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/registration/icp_scan.hpp"

namespace hybrid::testing {

// Random numbers of a trial, in order.
class Draw {
 public:
  explicit Draw(std::uint32_t seed, std::uint32_t purpose = 0) : seed_(seed), purpose_(purpose) {}
  double within(double low, double high);
  int below(int count);
  double normal();

 private:
  std::uint32_t seed_, purpose_, next_ = 0;
};

// The pose moved and turned by so much in random directions: rotation about the scanner.
Pose moved_at_random(const Pose& pose, double distance_m, double deg, std::uint32_t seed);

// A rectangular recess in the wall over a side of the footprint.
struct Recess {
  std::size_t side = 0;
  double from_m = 0, to_m = 0, low_m = 0, high_m = 0, depth_m = 0;
};

// A room over a footprint (counter-clockwise), faces inwards; `recesses` become holes with their five faces.
struct RoomPlan {
  std::vector<Vec2> footprint;
  double height_m = 3;
  std::vector<Recess> recesses;
};
PolygonModel room_model(const RoomPlan& plan);

// A room as it is, with furniture and recesses, and as its proxy shows it.
struct TrialRoom {
  PolygonModel truth, proxy;
  RoomPlan proxy_plan;
};

// kind: "box" (its proxy is symmetric), "niche" (a box whose proxy has one niche), "ell" (an L), "oblique"
// (four walls, no two parallel), "hall" (a box with three niches), "alcoves" (as "niche", but what the proxy
// lacks is as deep as its niche). The true room has furniture and up to three recesses that the proxy lacks;
// the proxy's faces are off by `proxy_error_m` (standard deviation).
TrialRoom make_trial_room(const std::string& kind, std::uint32_t seed, double proxy_error_m = 0);

struct TrialScan {
  RangeImage image;
  PlaneSegmentation segmentation;  // a supercluster per face that is seen
  Pose world_from_scan;
};

// A scan from a random free place in the room, turned and tilted about a degree, of `crop` of the full turn,
// 2 mm range noise.
TrialScan scan_trial_room(device::Queue& queue, const TrialRoom& room, std::uint32_t seed, double crop,
                          int rows = 150, int cols = 360);

// As scan-to-scan ICP takes it, so many samples of each kind.
std::unique_ptr<stages::IcpScan> icp_scan_of(device::Queue& queue, const TrialScan& scan, int samples);

// A scan, and as scan-to-scan ICP takes it.
struct SeenRoom {
  TrialScan scan;
  std::unique_ptr<stages::IcpScan> icp;
  const Pose& pose() const { return scan.world_from_scan; }
};

// Keeps what lies within `crop` of the full turn from `from_rad` of azimuth on.
void crop_scan(RangeImage& image, PlaneSegmentation& segmentation, double from_rad, double crop);

}  // namespace hybrid::testing
