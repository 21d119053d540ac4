#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "stages/registration/automatic_decision.hpp"
#include "stages/registration/automatic_scene.hpp"
#include "stages/registration/proxy_model.hpp"

namespace hybrid::stages {

struct AutomaticOptions {
  int rays = 16000;             // lines of sight a pose is judged by, chosen by area
  double tolerance_m = 0.05;    // a sample this near a face supports it
  double clear_m = 0.15;        // and beyond this it contradicts it
  double face_offset_m = 0.05;  // each face may be this far off
  double least_gap = 0.003;     // MarginRule: what must speak for a pose against every rival
  double least_consistency = 0.5;
  double least_without_largest = 0.0015;
  double least_firm = 0.003;
  double least_single = 0.06;
  double least_support = 0.35;  // of the planar area on faces
  // doubt(), planes off the faces against planes on them in the worst direction, where one that is on them
  // lies `tolerance_m` off. Where they fit exactly it may be twice as much.
  double most_doubt = 0.5;
  // Any corner lies on three planes, and one more (the height, say) fits by chance: so many of the model's
  // must hold the scan; walls that meet at an angle of their own count one more. Less than three more must
  // all lie within `tolerance_m`; less than one more within 0.7 of it, turned by half a degree at most, and
  // there may be less doubt.
  double least_planes = 5;
  double most_through = 0.35;  // of the planar area seen through faces
  double least_hold = 0.002;   // least resistance along any direction, share of the area
  int seed = 1;
  bool levelled = false;  // scanners stood upright
  // Of the scene, not of the option table:
  bool free_scale = false;
  // The model is another scan's planes: they have no backs, as what the other scan did not see is unknown.
  bool of_scan = false;
};
const std::vector<OptionRow<AutomaticOptions>>& automatic_option_table();

MarginRule margin_rule(const AutomaticOptions& options);

// A pose that the scan could nearly as well have.
struct RivalPose {
  Pose world_from_scan;
  std::string words;      // how it differs, motion_in_words()
  Comparison comparison;  // of the chosen pose against it
  double strength = 0;    // below 1: too close
  std::optional<double>
      seen_through;  // by the scans' samples (batch/registration/scan_to_scan.hpp), where these were asked
};

struct AutomaticAlignment {
  bool accepted = false;
  std::string reason;               // when not: in words, what is missing and what to do
  bool only_rivals = false;         // nothing speaks against the best pose but that others are nearly as good
  std::ptrdiff_t close_rivals = 0;  // of strength below 1, whether `rivals` names them or not
  std::optional<double> seen_through;  // as of rivals
  // Planes alone left a doubt, and the scans' samples told the pose: what that doubt was, the best pose by
  // planes, which the figures and rivals below are of, and what is seen through of samples of no plane.
  struct BySamples {
    std::string doubt;
    Pose best_by_planes;
    double free_seen_through = 0;
  };
  std::optional<BySamples> by_samples;
  Pose world_from_scan;  // the best pose, accepted or not; to be refined by ICP
  bool has_pose = false;
  double doubt = 0;  // doubt() of it
  // Of the model, under it: with 3 % of the planar area and more on them each, those with 1 % and more half,
  // one more where two of the former are oblique and all are turned by less than half a degree; and how far
  // the one that is farthest off is, and by how much that of the former which is turned most.
  double planes = 0, farthest_m = 0, farthest_rad = 0;
  SightShares shares;                // under it
  std::vector<std::uint32_t> faces;  // that hold 0.2 % of the planar area and more under it, ascending
  double margin = 0;                 // least gap to a rival, share of the planar area; 1 without rivals
  std::vector<RivalPose> rivals;     // closest first, at most 8
  std::vector<Pose> hypotheses;      // the best pose, and all rivals of strength below 1, closest first
  std::vector<Pose> beaten;          // all other rivals
  // Scan to scan, where the samples were asked: what they do not contradict of all these, after ICP.
  std::vector<Pose> uncontradicted;
  int rotations = 0, guesses = 0, finalists = 0;
  bool back = false;  // inverted(): the figures are of the other scan on the planes of this one
};

// METHOD 7: aligns superclusters to the proxy's faces without a start. Hypotheses from planes in fixed order,
// pruned; tile ICP; lines of sight traced through the model (kernel ray_cast); the best pose is accepted only
// when enough speaks for it against every other hypothesis and every near-symmetry of the proxy. Else
// abstains and names the rivals. What is wrong with scan or model as a whole (fewer than 3 planes, parallel
// planes, millimetres, mirrored) is a reason to abstain too, in words. Throws ErrorKind::input what
// measure_model() and triangulate() throw.
AutomaticAlignment align_automatically(device::Queue& queue, const ScanEvidence& scan,
                                       const ProxyModel& model, const AutomaticOptions& options = {});

// What an alignment of scan a to the planes of scan b says of b in a's frame: all poses inverted, the figures
// as they are.
AutomaticAlignment inverted(AutomaticAlignment alignment);

}  // namespace hybrid::stages
