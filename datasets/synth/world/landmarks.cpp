#include "world/landmarks.hpp"

#include <algorithm>
#include <limits>

#include "geometry/random.hpp"

namespace synth {
namespace {

constexpr std::size_t kLandmarks = 5;
constexpr double kPickErrorM = 0.01;
constexpr double kProbeM = 0.03;  // off the corner, into the open

}  // namespace

std::vector<Landmark> pick_landmarks(const World& world, const Tracer& tracer, const ScannerPose& pose,
                                     std::uint64_t seed, std::uint64_t scan_index) {
  const Eigen::Isometry3d scan_from_world = pose.world_from_scan.inverse();
  const auto& vertices = world.proxy.vertices;
  std::vector<std::size_t> visible, picked;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (!vertices[k].free.isZero() &&
        tracer.sees(pose.world_from_scan.translation(), vertices[k].position + kProbeM * vertices[k].free))
      visible.push_back(k);
  while (picked.size() < std::min(kLandmarks, visible.size())) {
    double widest = -1;
    std::size_t best = 0;
    for (std::size_t k : visible) {
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t p : picked)
        nearest = std::min(nearest, (vertices[k].position - vertices[p].position).norm());
      if (std::find(picked.begin(), picked.end(), k) == picked.end() && nearest > widest) {
        widest = nearest;
        best = k;
      }
    }
    picked.push_back(best);
  }
  if (picked.size() < 3) return {};
  Random random(seed, purpose::landmarks, scan_index);
  std::vector<Landmark> landmarks;
  for (std::size_t k : picked)
    landmarks.push_back(
        {scan_from_world * vertices[k].position + kPickErrorM * random.normal3(), world.proxy.moved[k]});
  return landmarks;
}

}  // namespace synth
