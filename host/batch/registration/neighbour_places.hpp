#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "batch/registration/recorded_poses.hpp"
#include "batch/registration/registration_unit.hpp"
#include "batch/registration/scan_to_scan.hpp"

namespace hybrid::batch {

// How many scans have one.
std::size_t count_of(const Registrations& registrations);

// The superclusters of each scan as a model that others are aligned to, made when first asked for.
class ScanModels {
 public:
  // `products` must outlive it.
  explicit ScanModels(const std::vector<ScanProduct>& products)
      : products_(products), models_(products.size()) {}

  struct Model {
    PolygonModel polygons;  // scan frame
    stages::ProxyModel model{polygons};
    stages::ModelShapes no_shapes{};
    explicit Model(PolygonModel made) : polygons(std::move(made)) {}
    const stages::ModelShapes& shapes() const { return polygons.faces.empty() ? no_shapes : model.shapes(); }
  };
  const Model& of(std::size_t scan);

 private:
  const std::vector<ScanProduct>& products_;
  std::vector<std::unique_ptr<Model>> models_;
};

// Places scans that have no pose on those that have one (METHOD 7): at the place on the model that these
// leave, or where the planes of one of them lay it. Takes scans from `abstentions` to `registrations`.
class NeighbourPlaces {
 public:
  // `model` may be null. The references must outlive it.
  NeighbourPlaces(device::Queue& queue, const stages::ProxyModel* model, const StageOptions& options,
                  const std::vector<ScanProduct>& products, ScanModels& models, ScanToScan& scan_to_scan,
                  RecordedPoses& recorded);

  // With a model: by ICP on it from where the scans' files have them beside those that have a pose; where the
  // model does not hold it there, on these scans; where neither tells, there, if the files' poses are
  // trusted.
  void lay_recorded(Registrations& registrations, Registrations& abstentions);
  // Those with hypotheses on the model, on all scans that have a pose at once.
  void lay_all(Registrations& registrations, Registrations& abstentions);
  // The scans of an island on those of another, each on all, from where all together tell the island's place;
  // false where they do not, and then nothing has changed. `unplaced`: the scans without a pose.
  bool lay_island(const Registrations& island, const Registrations& unplaced, Registrations& on);
  // All others, by planes; what abstains is told why.
  void carry_all(Registrations& registrations, Registrations& abstentions);
  // Where these alignments lay a scan that they leave without a pose, judged by all that have one.
  std::vector<PossiblePlace> possible_places(std::size_t scan, const Registrations& registrations);

 private:
  const stages::AutomaticAlignment& aligned(const ScanRegistration& scan, std::size_t index,
                                            std::size_t other);
  // aligned() the other way round: the other, which has a pose, to the planes of the scan.
  const stages::AutomaticAlignment& aligned_back(const ScanRegistration& other, std::size_t by,
                                                 std::size_t index);
  // An alignment of a scan without a pose to one that has one; none where it is null.
  struct Neighbour {
    std::size_t scan = 0, by = 0;
    const stages::AutomaticAlignment* alignment = nullptr;
    bool is_surer_than(const Neighbour& other) const;
  };
  // `back`: what those that have a pose tell of it when they are aligned to its planes, too.
  Neighbour best_neighbour(std::size_t scan, bool back, const Registrations& registrations,
                           const Registrations& abstentions);
  // Its alignments to scans that have a pose, as far as they were asked for.
  std::vector<Neighbour> known_of(std::size_t scan, const Registrations& registrations) const;
  // In the world, where its alignments to scans that have a pose lay it, each place once; `likely`: of those
  // that nothing or nothing but rivals speaks against.
  std::vector<Pose> places_of(std::size_t scan, const Registrations& registrations, bool likely) const;
  // Where the alignments between its scans and those of the other lay an island, each place once.
  std::vector<Pose> places_of_island(const Registrations& island, const Registrations& on) const;
  bool lay_recorded(std::size_t scan, const RecordedPoses::Start& start, Registrations& registrations,
                    Registrations& abstentions);
  void carry_one(const Neighbour& best, Registrations& registrations, Registrations& abstentions);
  // By samples, on all scans that have a pose; false where these contradict it.
  bool carry_by_samples(const Neighbour& best, Registrations& registrations, Registrations& abstentions);
  // carry_one(), or to another of its places, as all scans that have a pose at once say; false where these do
  // not tell.
  bool carry_by_all(const Neighbour& best, Registrations& registrations, Registrations& abstentions);
  // At the one of these places that all scans that have a pose at once leave; else why there is none.
  // `doubted`: as ScanToScan::choose() has it.
  std::string lay_at_one_of(const std::vector<Pose>& places, double least_rival, bool doubted,
                            std::size_t scan, Registrations& registrations, Registrations& abstentions);
  void lay(std::size_t scan, const Pose& start, OnScans on_scans, Registrations& registrations,
           Registrations& abstentions);
  // On other scans; one without a pose now has one.
  void place(std::size_t scan, ScanRegistration one, Registrations& registrations,
             Registrations& abstentions);
  // The same, whatever placed it; `instead`: of a place that was refused, in words.
  void accept(std::size_t scan, ScanRegistration one, const std::string& instead,
              Registrations& registrations, Registrations& abstentions);

  device::Queue& queue_;
  const stages::ProxyModel* model_;
  const StageOptions& options_;
  const std::vector<ScanProduct>& products_;
  ScanModels& models_;
  ScanToScan& scan_to_scan_;
  RecordedPoses& recorded_;
  // By scan, why lay_recorded() and lay_all() left it without a pose.
  std::vector<std::string> by_file_, on_all_;
  // By scan, its alignments to others' planes, and those of others to its own, inverted.
  std::vector<std::map<std::size_t, stages::AutomaticAlignment>> aligned_, aligned_back_;
};

}  // namespace hybrid::batch
