#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/cylinder.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {

// A registered scan as evidence of what is in sight and what is not.
struct SightScan {
  const RangeImage* image = nullptr;
  const std::vector<std::uint32_t>* sample_label = nullptr;  // per node, 0: no supercluster; or empty
  const std::vector<std::uint8_t>* stray = nullptr;          // per node, Stray; or empty
  Pose world_from_scan;
  const std::vector<Cylinder>* cylinders = nullptr;  // that it shows, its own frame
};

// A column or a pipe that a scan shows, world frame.
struct SightColumn {
  std::size_t scan = 0;
  Cylinder cylinder;
};

// What another scan, whose samples are closer together, has of a surface that a scan shows, too.
struct FinerSamples {
  bool at_edge = false;  // it has none of that surface on some side, or none at all: it sees past it
  double spacing_m = 0;  // its steps there, world frame
};

// What registered scans say of places in the world. A scan sees past a place where it has a sample behind it,
// and where it looks at the sky: no sample around there nor anywhere above, in a scan all around, no farther
// away than it has any. (A surface too dark or too smooth to return has others above it.)
class ScanSight {
 public:
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  // The scans must outlive this. A sample this far behind a place shows that the place is empty.
  ScanSight(const std::vector<SightScan>& scans, double tolerance_m);

  // Whether a scan other than `but` sees past the place.
  bool is_empty(const Vec3& place, std::size_t but = kAll) const;

  // Whether a scan other than `but` sees past the place, and past those `margin_m` around it, by as much and
  // more; one that has a sample at least every `spacing_m` there, for others miss what is thin.
  bool is_seen_through(const Vec3& place, double margin_m, double spacing_m, std::size_t but) const;

  // Of the scans but `scan` that show the surface at a place that this one has a sample of, the first whose
  // samples there lie at least `times` closer together; where all those are at an edge of it, or see past the
  // place by `past_m` and more, the closest one.
  std::optional<FinerSamples> seen_finer(const Vec3& place, std::size_t scan, double times,
                                         double past_m) const;

  // Whether this scan sees something before the place.
  bool is_hidden(const Vec3& place, std::size_t scan) const;

  // Known: a scan has a sample at the place; where one has none in that direction, the surface is there
  // beside it. Empty, whatever others have there: a scan sees past it.
  enum class Known { no, yes, empty };
  Known known(const Vec3& place) const;

  // Samples of all scans within a radius of a place, no strays, world frame; of a scan with more than about
  // `many` there those of every few rows and columns. In the order of scans and nodes.
  std::vector<Vec3> samples_near(const Vec3& place, double radius_m, double many = 1e5) const;

  // Those that the scans show, in the order of scans and ids; vaults are none.
  std::vector<SightColumn> columns() const;

  const std::vector<SightScan>& scans() const { return scans_; }
  double tolerance_m() const { return tolerance_m_; }

 private:
  struct Sky {
    std::vector<int> rows;  // per column: so many from the first one on have no sample; empty: not known
    double farthest_m = 0;  // sample
  };
  static Sky sky_of(const RangeImage& image);

  friend class SightWalk;
  // `towards`: of a scan and a place in its frame, the node.
  template <typename Towards>
  Known known(const Vec3& place, const Towards& towards) const;
  bool is_beside(std::size_t scan, const NodeLookup::Node& node, double range_m) const;
  std::optional<double> spacing_m(std::size_t scan, int row, int col) const;
  std::optional<double> range_m(std::size_t scan, int row, int col) const;
  // Of a node's sample; of one that looks at the sky as far as the scan's farthest sample is.
  std::optional<double> sight_m(std::size_t scan, int row, int col) const;
  std::vector<Vec3> samples_near(std::size_t scan, const Vec3& point, double radius_m, double many) const;

  const std::vector<SightScan>& scans_;
  double tolerance_m_;
  std::vector<NodeLookup> lookups_;
  std::vector<Pose> scan_from_world_;
  std::vector<Sky> skies_;
};

// Asks about places that come one beside the other: what ScanSight::known() says, in a fraction of the time.
// The sight must outlive it.
class SightWalk {
 public:
  explicit SightWalk(const ScanSight& sight);
  ScanSight::Known known(const Vec3& place);

 private:
  const ScanSight& sight_;
  std::vector<NodeWalk> walks_;
};

}  // namespace hybrid::stages
