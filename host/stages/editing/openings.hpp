#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "geometry/face_frame.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

struct OpeningOptions {
  std::string openings = "off";       // "off" | "report" | "cut"
  double opening_depth_m = 0.10;      // returns at least this far behind a face passed through it
  double opening_area_m2 = 0.05;      // smaller ones are not reported
  int opening_rays = 100;             // nor such that fewer lines of sight pass
  double opening_confidence = 0.5;    // less confident ones are not cut
  double opening_displaced_m = 0.10;  // a face this far off its surface is reported, its openings not cut
};
const std::vector<OptionRow<OpeningOptions>>& opening_option_table();

// A registered scan as evidence.
struct OpeningScan {
  const RangeImage* image = nullptr;
  const PlaneSegmentation* segmentation = nullptr;
  const std::vector<std::uint8_t>* ignored = nullptr;  // per node, not 0: no evidence; or null
  Pose world_from_scan;
  double sigma_m = 0;                   // range noise
  std::array<double, 36> covariance{};  // of the pose, as Registration has it; zero: exact
};

// What the cells of a face say.
enum class CellEvidence : std::uint8_t {
  none,
  closed,    // samples on the face
  attached,  // samples just before it, on what stands out of it
  behind,    // samples a little behind it: reveals
  through,   // lines of sight through it
};

struct Opening {
  std::size_t face = 0;
  double cell_m = 0;  // of the face's grid: how far the ring may reach beyond the face
  Ring2 ring;         // face coordinates, counter-clockwise
  double area_m2 = 0;
  std::int64_t rays = 0;           // lines of sight that pass through it
  std::int64_t against = 0;        // samples on the face inside it
  double border_seen = 0;          // share of its border that has samples on the face beside it
  double on_outline = 0;           // share of its border that is the face's own outline
  double confidence = 0;           // lower bound (95 %) of the share of rays that pass, times border_seen
  double depth_m = 0;              // median of how far behind the face the rays return
  std::optional<double> pane_m{};  // how far behind the face glass closes it (panes.hpp)
  std::optional<double> likely_pane_m{};      // where it may, if another side of the wall says so, too
  std::optional<std::size_t> pane_from{};     // the face of the wall's other side that shows the glass
  std::optional<std::size_t> carried_from{};  // the face of the wall's other side that its border was seen on
  std::optional<std::size_t> completed_from{};  // the face of the whole opening whose border it has
  std::string kind;  // "open" | "glass" (some return from one pane) | "recess" (nearly all from one plane)
  bool cut = false;
  std::string why_not;  // not cut
};

// One face and the evidence on it.
struct FaceEvidence {
  std::size_t face = 0;
  std::int64_t samples = 0;  // on it or through it
  bool seen = false;         // enough samples lie parallel to it to tell where its surface is
  double offset_m = 0;       // of that surface from the face, towards its front positive
  double spread_m = 0;       // of the samples about the surface, 1.4826 times the median deviation
  double depth_m = 0;        // that an opening must have: the option's, or 3 sigma of pose and proxy
  std::string status;        // "as modelled" | "displaced" | "absent" | "unseen"
  double cell_m = 0;         // of the grid from the frame's origin
  int cols = 0, rows = 0;
  std::vector<CellEvidence> cells;  // row 0 lowest; empty where nothing was found to tell
  std::vector<Ring2> pieces;  // open, but too narrow or with too little of a border to be openings alone
};

struct Openings {
  std::vector<Opening> openings;    // by face, then from the largest
  std::vector<FaceEvidence> faces;  // one per face of the model
};

// METHOD 9: hole polygons from lines of sight. For every face, samples are taken from all scans: on its
// surface (closed), before it, and behind it, which says that the line of sight passed. The surface's median
// offset is subtracted first. A grid of about the sample spacing collects them; each place belongs to the
// nearer kind of evidence, so that borders run half-way between. A border becomes the circle, or the jambs
// and sill under lintel or arch, that fits the samples around it (opening_shape.hpp); where none does it is
// straightened, edges near the axes of the face made parallel to them, and placed where they part the samples
// best (opening_border.hpp). What hides a part of one is no part of its border where another of the same
// design is seen whole (opening_design.hpp). Faces that no scan sees, or sees little of, get the openings of
// their wall's other side (opening_carry.hpp). Same result for any number of threads.
Openings find_openings(const PolygonModel& model, const std::vector<OpeningScan>& scans,
                       const OpeningOptions& options);

}  // namespace hybrid::stages
