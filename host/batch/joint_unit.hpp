#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "batch/registration_unit.hpp"
#include "stages/joint_poses.hpp"

namespace hybrid::batch {

using Registrations = std::vector<std::optional<ScanRegistration>>;

// The scans of one scene among each other (METHOD 7). A scan without a pose of its own, because the alignment
// to the model abstained or there is no model, is aligned to the planes of those that have one; what abstains
// there, too, stays without. Without a model the first scan is the frame: its pose is the scene file's or
// none. Then all poses are refined together. Takes scans from `abstentions` to `registrations`.
class NeighbourRegistration {
 public:
  // `model` may be null. The references must outlive it.
  NeighbourRegistration(device::Queue& queue, const stages::ProxyModel* model, const StageOptions& options,
                        const std::vector<ScanProduct>& products);

  // Without a model: the first scan's pose, and all others as not yet aligned.
  void begin_without_model(const std::vector<io::SceneScan>& entries, Registrations& registrations,
                           Registrations& abstentions) const;
  void carry(Registrations& registrations, Registrations& abstentions);
  // [register] joint = true and at least two scans with a pose.
  void refine(Registrations& registrations);

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
  bool carry_one(std::size_t scan, Registrations& registrations, Registrations& abstentions);

  device::Queue& queue_;
  const stages::ProxyModel* model_;
  const StageOptions& options_;
  const std::vector<ScanProduct>& products_;
  std::vector<std::unique_ptr<Seen>> seen_;
  nlohmann::ordered_json figures_;
};

}  // namespace hybrid::batch
