#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "batch/registration/registration_unit.hpp"
#include "stages/registration/island_places.hpp"
#include "stages/registration/likely_places.hpp"
#include "stages/registration/pair_places.hpp"
#include "stages/registration/scan_hypotheses.hpp"

namespace hybrid::batch {

using Registrations = std::vector<std::optional<ScanRegistration>>;

// Of the scan, or of another one, so much on each other's surfaces holds it firmly.
inline constexpr double kFirmOverlap = 0.2;
double largest_overlap(const stages::ScanIcp& found);

// Lays scans on each other by their samples, planar or not (METHOD 6, stages/registration/scan_icp.hpp).
class ScanToScan {
 public:
  // The references must outlive it.
  ScanToScan(device::Queue& queue, const StageOptions& options, const std::vector<ScanProduct>& products);

  // How a scan lies on the scans that have a pose under a pose (world) as it is; `through`: the area that is
  // seen through, both ways, as a share of the scan's.
  struct Look {
    OnScans on_scans;
    double through = 0;
  };
  Look look(std::size_t i, const Pose& pose, const Registrations& registrations);

  // ICP on the scans that have a pose, and what speaks against where it ends; "" = nothing.
  struct Laid {
    OnScans on_scans;
    std::string contradiction;
  };
  // From a hypothesis of the scan's pose (world).
  Laid lay(std::size_t i, const Pose& start, const Registrations& registrations);
  // From a start that was given, and from beside what that finds as long as it finds better; where little
  // holds the scan nothing else there may fit as well.
  Laid lay_from(std::size_t i, const Pose& start, const Registrations& registrations);

  // Judges an alignment of scan `i` to scan `other` by planes alone, in whose frame it is: places that are
  // alike have planes that fit, and are seen through. Where nothing but rivals spoke against it, and the
  // scans see through these, it is accepted; and where its planes are too few, but the samples tell one of
  // all poses that were looked at (stages/registration/pair_places.hpp), that one is.
  void judge(std::size_t i, std::size_t other, stages::AutomaticAlignment& found);

  // Of hypotheses of the scan's pose (world) the one that the scans that have a pose leave (METHOD 7,
  // stages/registration/scan_hypotheses.hpp); `others`: their ids, in the order of found.others.
  // `least_rival`: as there. `doubted`: planes speak against these hypotheses; then what is no plane must
  // speak for the one that is chosen, as where it tells of two scans alone (pair_places.hpp).
  struct Chosen {
    stages::ChosenHypothesis hypothesis;
    std::vector<std::string> others;
  };
  Chosen choose(std::size_t i, const std::vector<Pose>& hypotheses, const Registrations& registrations,
                double least_rival = 0, bool doubted = false);

  // The likeliest of such hypotheses (stages/registration/likely_places.hpp), and what speaks for them.
  std::vector<PossiblePlace> best_places(std::size_t i, const std::vector<Pose>& places,
                                         const Registrations& registrations, std::size_t most);

  // Of an island as one: the place among these (to the frame of `on`) that the samples of all scans of both
  // leave; `order` counts its scans.
  std::optional<stages::IslandFit> place_of_island(const Registrations& island, const Registrations& on,
                                                   const std::vector<Pose>& places);

  // Of a scan that slides() where the scans that have a pose and do not slide hold it; nothing where there
  // are none.
  std::optional<OnSlide> hold_slide(std::size_t i, const Registrations& registrations);

  // Every scan's figures and distances to the others under its final pose.
  void describe(Registrations& registrations);

 private:
  const stages::IcpScan& scan(std::size_t i);
  struct Others {
    std::vector<stages::PlacedScan> scans;
    std::vector<std::string> ids;
  };
  // ICP from a start, and from beside what it finds as long as that finds better.
  stages::ScanIcp best_from(std::size_t i, const Others& others, const Pose& start);
  // Another place that ICP finds from beside this one, in words; "" = none.
  std::string rival_of(std::size_t i, const Others& others, const Pose& found);
  void judge_by_planes(std::size_t i, std::size_t other, stages::AutomaticAlignment& found);
  void judge_by_samples(std::size_t i, std::size_t other, stages::AutomaticAlignment& found);
  // `firm`: without those that slide.
  Others others_than(std::size_t i, const Registrations& registrations, bool firm = false);
  // To those others that it has to do with, under its pose.
  void measure_distances(std::size_t i, const Others& others, ScanRegistration& one);

  device::Queue& queue_;
  const StageOptions& options_;
  stages::ScanIcpOptions icp_, few_;  // with all samples, with an eighth
  const std::vector<ScanProduct>& products_;
  std::vector<std::unique_ptr<stages::IcpScan>> scans_;
  std::vector<stages::PlaceTallies> tallies_;  // by scan
};

}  // namespace hybrid::batch
