#pragma once
#include <optional>
#include <string>
#include <vector>

#include "batch/registration/recorded_poses.hpp"
#include "batch/registration/scan_to_scan.hpp"

namespace hybrid::batch {

// Without a model: places scans whose poses the scene file or their own files give on those that have one
// (METHOD 7). Takes scans from `abstentions` to `registrations`.
class StartPlaces {
 public:
  // The references must outlive it.
  StartPlaces(const std::vector<ScanProduct>& products, ScanToScan& scan_to_scan, RecordedPoses& recorded);

  // A pose (world) that the scene file gives.
  void give(std::size_t i, const Pose& world_from_scan);
  // That of the scan's file, if there is one beside that of the frame's, whose pose is known. `guess`: that
  // both files' coordinates are of one frame, as the scene file says where their scanners stood.
  void give_recorded(std::size_t i, std::size_t frame, const Pose& world_from_frame, bool guess);
  // Some were given; scan i's still waits.
  bool any() const { return any_; }
  bool waits(std::size_t i) const { return starts_[i].has_value(); }

  // Those that the scans' files give, where these are trusted: by ICP where other scans hold one firmly; what
  // they hold too little to tell stays where its file has it.
  void place_recorded(Registrations& registrations, Registrations& abstentions);
  // ICP from these starts on the scans that have a pose, those that overlap most first, as far as they hold a
  // scan firmly; the others keep their starts.
  void place_firmly(Registrations& registrations, Registrations& abstentions);
  // ICP from all starts; a pose that the scans contradict is refused, with the numbers. One that no other
  // scan can judge stays as it is.
  void place(Registrations& registrations, Registrations& abstentions);

 private:
  struct Start {
    Pose world_from_scan;
    std::string from;       // "given" | "recorded" | "coordinates"
    std::size_t frame = 0;  // of a recorded one
    // What ICP made of it last, and what speaks against that: "" = nothing.
    std::optional<OnScans> found{};
    std::string contradiction{};
  };
  bool place_one(std::size_t i, double least_overlap, Registrations& registrations,
                 Registrations& abstentions);
  bool is_trusted(const Start& start);
  // By the word of the files; `keep`: where others hold it too little, too.
  bool place_near(std::size_t i, bool keep, Registrations& registrations, Registrations& abstentions);
  // Where ICP found it.
  void accept(std::size_t i, Registrations& registrations, Registrations& abstentions);
  void place_down_to(double least_overlap, Registrations& registrations, Registrations& abstentions);
  void refuse_recorded(std::size_t i, const Registrations& registrations, Registrations& abstentions);
  void settle(std::size_t i, Registrations& registrations, Registrations& abstentions);

  const std::vector<ScanProduct>& products_;
  ScanToScan& scan_to_scan_;
  RecordedPoses& recorded_;
  std::vector<std::optional<Start>> starts_;  // by scan
  bool any_ = false;
};

}  // namespace hybrid::batch
