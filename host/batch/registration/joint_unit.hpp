#pragma once
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "batch/registration/registration_unit.hpp"
#include "batch/registration/scan_to_scan.hpp"
#include "stages/registration/joint_poses.hpp"

namespace hybrid::batch {

// The scans of one scene among each other (METHOD 7). Without a model the first scan is the frame: its pose
// is the scene file's, else that in its file, else none; the poses that these give others are where ICP on
// the other scans starts (scan_to_scan.hpp). Where nothing gives a pose and more scans hang together without
// the first than with it, the first of those is the frame. A scan without a pose of its own, because the
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
  // and the smaller groups that have no pose, each in its own frame.
  void refine(Registrations& registrations, Registrations& abstentions);

  // summary.json's "joint": null when refine() did nothing.
  nlohmann::ordered_json figures() const { return figures_; }

 private:
  struct Seen {
    PolygonModel polygons;  // of its superclusters, scan frame
    stages::ProxyModel model{polygons};
    stages::ModelShapes no_shapes{};
    explicit Seen(PolygonModel made) : polygons(std::move(made)) {}
    const stages::ModelShapes& shapes() const { return polygons.faces.empty() ? no_shapes : model.shapes(); }
  };
  const Seen& seen(std::size_t scan);
  nlohmann::ordered_json refine_all(Registrations& registrations);
  // Along what the model leaves open, those first that scans which do not slide hold.
  void hold_slides(Registrations& registrations);
  const stages::AutomaticAlignment& aligned(const ScanRegistration& scan, std::size_t index,
                                            std::size_t other);
  // An alignment of a scan without a pose to one that has one; none where it is null.
  struct Neighbour {
    std::size_t scan = 0, by = 0;
    const stages::AutomaticAlignment* alignment = nullptr;
    bool is_surer_than(const Neighbour& other) const;
  };
  Neighbour best_neighbour(std::size_t scan, const Registrations& registrations,
                           const Registrations& abstentions);
  void carry_one(const Neighbour& best, Registrations& registrations, Registrations& abstentions);
  // In the world, where its alignments to scans that have a pose lay it, each place once; `only_rivals`: of
  // those that nothing but rivals speaks against.
  std::vector<Pose> places_of(std::size_t scan, const Registrations& registrations, bool only_rivals) const;
  // carry_one(), or to another of its places, as all scans that have a pose at once say; false where these do
  // not tell.
  bool carry_by_all(const Neighbour& best, Registrations& registrations, Registrations& abstentions);
  // To one of the places that nothing but rivals speaks against, as all scans that have a pose at once say.
  bool lay_by_neighbours(std::size_t scan, Registrations& registrations, Registrations& abstentions);
  // On all scans that have a pose at once, by its own hypotheses on the model.
  bool lay_one(std::size_t scan, Registrations& registrations, Registrations& abstentions);
  void lay(std::size_t scan, const ScanToScan::Chosen& chosen, Registrations& registrations,
           Registrations& abstentions);
  void lay_all(Registrations& registrations, Registrations& abstentions);
  // One without a pose now has one.
  void place(std::size_t scan, ScanRegistration one, Registrations& registrations,
             Registrations& abstentions);
  void carry_all(Registrations& registrations, Registrations& abstentions);
  void keep_largest_island(Registrations& registrations, Registrations& abstentions);
  void tell_island(Registrations& island, Registrations& abstentions);

  device::Queue& queue_;
  const stages::ProxyModel* model_;
  const StageOptions& options_;
  const std::vector<ScanProduct>& products_;
  std::vector<std::unique_ptr<Seen>> seen_;
  ScanToScan scan_to_scan_;
  std::vector<std::optional<ScanStart>> starts_;
  std::vector<std::string> on_all_;            // by scan, why lay_one() left it without a pose
  std::vector<std::optional<Pose>> recorded_;  // in the scans' files, without the scene's shift
  std::vector<Registrations> islands_;         // that keep_largest_island() left without a pose
  bool frame_is_free_ = false;  // nothing but its place in the list makes the first scan the frame
  std::vector<std::map<std::size_t, stages::AutomaticAlignment>> aligned_;  // by scan, to others' planes
  nlohmann::ordered_json figures_;
};

}  // namespace hybrid::batch
