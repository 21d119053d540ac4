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

// The start of scans whose scanner positions the scene file gives: that their files' coordinates are of one
// frame is a guess.
inline constexpr const char* kOneFrame = "coordinates";

// A pose that was given for a scan without a model.
struct ScanStart {
  Pose world_from_scan;
  std::string from;  // "given" | "recorded" | kOneFrame
  // What ICP made of it last, and what speaks against that: "" = nothing.
  std::optional<OnScans> found{};
  std::string contradiction{};
};

// The start that a scan's file gives: its pose there, relative to that of the frame, whose pose in the world
// is known. The same pose as the frame's says nothing: scans that were never registered all have the
// identity.
std::optional<ScanStart> recorded_start(const std::optional<Pose>& recorded, const Pose& frame_recorded,
                                        const Pose& world_from_frame);

// Lays scans on each other by their samples, planar or not (METHOD 6, stages/registration/scan_icp.hpp).
class ScanToScan {
 public:
  // The references must outlive it.
  ScanToScan(device::Queue& queue, const StageOptions& options, const std::vector<ScanProduct>& products);

  // ICP from these starts on the scans that have a pose, those that overlap most first; a pose that the scans
  // contradict is refused, with the numbers. One that no other scan can judge stays as it is. Takes scans
  // from `abstentions` to `registrations`, or leaves them there, refused.
  void place(std::vector<std::optional<ScanStart>>& starts, Registrations& registrations,
             Registrations& abstentions);
  // Of these, before, only those that the scans hold firmly; the others keep their starts.
  void place_firmly(std::vector<std::optional<ScanStart>>& starts, Registrations& registrations,
                    Registrations& abstentions);

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

  // ICP from a pose (world) on all scans that have one, and what speaks against where it ends; "" = nothing.
  struct Laid {
    OnScans on_scans;
    std::string contradiction;
  };
  Laid lay(std::size_t i, const Pose& start, const Registrations& registrations);

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
  bool place_one(std::size_t i, double least_overlap, ScanStart& start, Registrations& registrations,
                 Registrations& abstentions);
  void place_down_to(double least_overlap, std::vector<std::optional<ScanStart>>& starts,
                     Registrations& registrations, Registrations& abstentions);
  void settle(std::size_t i, const ScanStart& start, Registrations& registrations,
              Registrations& abstentions);
  void judge_by_planes(std::size_t i, std::size_t other, stages::AutomaticAlignment& found);
  void judge_by_samples(std::size_t i, std::size_t other, stages::AutomaticAlignment& found);
  void warn(std::size_t i, std::string text, ScanRegistration& one) const;
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
