#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "batch/registration/neighbour_places.hpp"
#include "batch/registration/recorded_poses.hpp"
#include "batch/registration/registration_unit.hpp"
#include "batch/registration/scan_to_scan.hpp"
#include "batch/registration/start_places.hpp"
#include "stages/registration/joint_poses.hpp"

namespace hybrid::batch {

// The scans of one scene among each other (METHOD 7). Without a model the first scan is the frame: its pose
// is the scene file's, else that in its file, else none; the poses that these give others are where ICP on
// the other scans starts (scan_to_scan.hpp). Where nothing gives a pose and more scans hang together without
// the first than with it, the one of those on which the others were laid is. With a model a scan that has no
// pose on it begins where its file has it beside one that has. A scan without a pose of its own, because the
// alignment to the model abstained or nothing gave one that holds, is aligned to the planes of those that
// have one; what abstains there, too, stays without. Then all poses are refined together. Takes scans from
// `abstentions` to `registrations`.
class NeighbourRegistration {
 public:
  // `model` may be null. The references must outlive it.
  NeighbourRegistration(device::Queue& queue, const stages::ProxyModel* model, const StageOptions& options,
                        const std::vector<ScanProduct>& products);

  // Without a model: the first scan's pose, and all others as not yet aligned. `shift`: the scene's, which
  // poses in scan files contain.
  void begin_without_model(const std::vector<io::SceneScan>& entries, const Vec3& shift,
                           Registrations& registrations, Registrations& abstentions);
  void carry(Registrations& registrations, Registrations& abstentions);
  // Where [register] joint = true and at least two scans have a pose. Without a model also what lies on what,
  // and the smaller groups that have no pose, each in its own frame. Then where scans without one may stand.
  void refine(Registrations& registrations, Registrations& abstentions);

  // summary.json's "joint": null when refine() did nothing.
  nlohmann::ordered_json figures() const { return figures_; }

 private:
  nlohmann::ordered_json refine_all(Registrations& registrations);
  // Along what the model leaves open, those first that scans which do not slide hold.
  void hold_slides(Registrations& registrations);
  // Without a model.
  Pose recorded_or_none(std::size_t scan) const;  // in its file
  void place_from_starts(Registrations& registrations, Registrations& abstentions);
  void keep_largest_island(Registrations& registrations, Registrations& abstentions);
  void join_islands(std::vector<Registrations>& islands);
  void tell_island(Registrations& island, Registrations& abstentions);
  // Where a scan without a pose may stand: on the model where nothing but other places there speaks against
  // one, else on other scans, where these know one.
  std::vector<PossiblePlace> places_of(std::size_t i, const ScanRegistration& abstained,
                                       const Registrations& registrations);

  device::Queue& queue_;
  const stages::ProxyModel* model_;
  const StageOptions& options_;
  const std::vector<ScanProduct>& products_;
  ScanModels models_;
  ScanToScan scan_to_scan_;
  RecordedPoses recorded_;
  StartPlaces starts_;
  NeighbourPlaces places_;
  Vec3 shift_ = Vec3::Zero();           // the scene's, in the poses of scan files
  std::vector<Registrations> islands_;  // that keep_largest_island() left without a pose
  bool frame_is_free_ = false;          // nothing but its place in the list makes the first scan the frame
  nlohmann::ordered_json figures_;
};

}  // namespace hybrid::batch
