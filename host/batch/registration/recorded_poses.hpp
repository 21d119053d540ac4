#pragma once
#include <optional>
#include <string>
#include <vector>

#include "batch/registration/scan_to_scan.hpp"

namespace hybrid::batch {

// Whether two poses of a scan lie within decimetres and few degrees of each other.
bool is_one_place(const Pose& a, const Pose& b);

// Whether they are the same but for a survey's errors, and `more_m` besides.
bool agree(const Pose& a, const Pose& b, double more_m = 0);

// A pose in a scan's file is contradicted where of the scan's area so much is seen through by other scans, or
// of theirs by it. Of 60 scans of churches right ones have 0.04 at most, those decimetres off 0.1 and more
// wherever there is something to compare.
inline constexpr double kMostThroughRecorded = 0.05;

// The poses in scan files: in one frame where they were registered before, by whatever means (METHOD 7).
class RecordedPoses {
 public:
  // The references must outlive it.
  RecordedPoses(const std::vector<ScanProduct>& products, ScanToScan& scan_to_scan);

  // The pose (world) of scan `i` where that of scan `by` is known. None where a file has none, and where both
  // have the same: scans that were never registered all have the identity.
  std::optional<Pose> pose_by(std::size_t i, std::size_t by, const Pose& world_from_by) const;

  // The same by the nearest of those that have a pose, one that slides() last; none where most others lead
  // elsewhere.
  struct Start {
    Pose world_from_scan;
    std::size_t by = 0;
  };
  std::optional<Start> start_of(std::size_t i, const Registrations& registrations) const;
  // The same by the word of the files, if they are trusted: by one of the scans that agree.
  std::optional<Start> trusted_start_of(std::size_t i, const Registrations& registrations);

  // Found when first asked for.
  const RecordedWord& word();

  // Of a scan that has a pose: that by the word of the files, if they are trusted, it or the nearest of the
  // others stands elsewhere; "" = not.
  std::string contradiction_of(std::size_t i, const Registrations& registrations);

  // That a scan has its file's pose, by that of scan `by`, as nothing else tells: into `one`, with a warning.
  void keep(std::size_t i, const Start& start, ScanRegistration& one);

 private:
  // The scans whose recorded places are nearest to that of scan `i`, the nearest first.
  std::vector<std::size_t> nearest(std::size_t i) const;
  std::optional<Start> start_by(std::size_t i, std::vector<std::size_t> others,
                                const Registrations& registrations) const;
  void ask(std::size_t i, RecordedWord& word);

  const std::vector<ScanProduct>& products_;
  ScanToScan& scan_to_scan_;
  std::optional<RecordedWord> word_;
  std::vector<std::uint8_t> agrees_;  // by scan
};

}  // namespace hybrid::batch
