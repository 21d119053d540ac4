#pragma once
#include <span>
#include <vector>

#include "device/queue.hpp"
#include "stages/registration/automatic_scene.hpp"
#include "stages/registration/proxy_model.hpp"
#include "stages/rendering/bvh.hpp"

namespace hybrid::stages {

// What a hypothetical pose says of a measured line of sight.
enum class Sight : std::uint8_t {
  supported,  // a face's front is where the sample is, and faces as the sample's plane does
  near,       // a face is there, but not quite: speaks neither for nor against the pose
  in_front,   // the sample lies in front of the face: clutter, or the pose is wrong
  through,    // the line of sight passes through a face: an opening, or the pose is wrong
  behind,     // the scanner would stand behind the face it sees
  nothing     // no face there: the model is not complete, or the pose is wrong
};

struct SightLine {
  Sight sight = Sight::nothing;
  std::uint32_t face = 0;  // index in the model; of the first face on the line
  bool recess = false;     // it is one of a recess's
};

struct SightOptions {
  double tolerance_m = 0.05;  // of support, measured across the face
  double clear_m = 0.15;      // beyond this a sample is clearly in front or behind
  double offset_m = 0.05;     // each face may be this far off: a pose is judged with the offsets that fit it
  double recess_m = 0.035;    // a recess's faces (SightCaster) may be this far off to speak for a pose
  bool recesses = true;       // false: they are no more than other faces
  double normal_deg = 25;     // between the sample's plane and the face
  bool backs = true;          // a face has a back, from which nothing can be seen; else its back says nothing
};

// Traces lines of sight through the model on the device. A recess of the scan that the model lacks may by
// chance come to lie where the model has one, its back on the other's back: small faces that share edges are
// taken together, and one of them supports a pose only where the others that are seen do so, too.
class SightCaster {
 public:
  SightCaster(device::Queue& queue, const ProxyModel& model);

  // One per ray of the evidence, in order. Only every `stride`-th ray is cast; the others are left out.
  // Kernel: ray_cast.
  std::vector<SightLine> cast(const std::vector<SightRay>& rays, const Pose& world_from_scan,
                              const SightOptions& options, std::size_t stride = 1);
  // The same of each pose, many in one launch.
  std::vector<std::vector<SightLine>> cast(const std::vector<SightRay>& rays, const std::vector<Pose>& poses,
                                           const SightOptions& options, std::size_t stride = 1);

 private:
  struct Hit;
  struct Seen {
    std::size_t rays_of_each = 0;  // of a pose, one after the other
    std::vector<float> distance_m;
    std::vector<std::uint32_t> id;
  };
  Seen trace(const std::vector<SightRay>& rays, std::span<const Pose> poses, std::size_t stride);
  std::vector<SightLine> judge_all(const std::vector<SightRay>& rays, const Pose& world_from_scan,
                                   const SightOptions& options, std::size_t stride, const Seen& seen,
                                   std::size_t pose) const;
  void doubt_recesses(const std::vector<SightRay>& rays, std::size_t stride, const std::vector<Hit>& hits,
                      const SightOptions& options, std::vector<SightLine>& lines) const;

  device::Queue& queue_;
  std::vector<Plane> planes_;          // of the faces
  std::vector<std::uint32_t> recess_;  // of the faces: which one each belongs to; 0: none
  Vec3 origin_ = Vec3::Zero();
  DeviceBvh bvh_;
};

// Shares of the planar area.
struct SightShares {
  double supported = 0, in_front = 0, through = 0, behind = 0, nothing = 0;
  double score = 0;  // what the search ranks by
};
SightShares shares_of(const std::vector<SightRay>& rays, const std::vector<SightLine>& lines,
                      std::size_t stride = 1);

}  // namespace hybrid::stages
