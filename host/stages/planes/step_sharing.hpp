#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/plane.hpp"
#include "geometry/range_image.hpp"
#include "stages/planes/plane_regions.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// A sample's height over a plane, metres, and the inverse of the variance that noise gives it along the
// normal; weight 0 = says nothing (not measured).
struct PlaneHeight {
  double height_m = 0, weight = 0;
};
PlaneHeight height_over(const RangeImage& image, const RangeNoise& noise, const Plane& plane, std::size_t i);

// Whether a surface may go on between two samples beside or on a plane: by less than 45 degrees and `slack_m`
// out of the plane, and not over a gap.
bool surface_goes_on(const Plane& plane, const Vec3& from, const Vec3& to, double slack_m);
inline constexpr double kContinuitySigmas = 3;  // of the noise there, as that slack

// Measured, and on no plane.
inline bool is_on_no_plane(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                           const PlaneRegions& regions, std::size_t i) {
  return image.mask[i] == kMeasured && (labels[i] == 0 || regions.regions[labels[i] - 1].curved);
}

struct MeanHeight {
  double sum = 0, weight = 0;
  std::int64_t count = 0;

  void add(const PlaneHeight& height) {
    sum += height.weight * height.height_m;
    weight += height.weight;
    count += height.weight > 0;
  }
  void add(const MeanHeight& other) {
    sum += other.sum;
    weight += other.weight;
    count += other.count;
  }
  double value_m() const { return weight > 0 ? sum / weight : 0; }
};

// Touching samples of one plane that lie to one side of it on the mean.
struct StepProposal {
  std::uint32_t label = 0;  // of the plane
  MeanHeight mean;
  int top = 0, left = 0, bottom = 0, right = 0;  // samples of the image, the last two exclusive
  std::optional<Plane> border;                   // across the plane, if known: the part is before it
};

enum class StepVerdict {
  none,
  step,   // a plane parallel to the proposal's
  curved  // where a curved surface leaves the plane
};

// The samples of a plane around a proposal, shared between the plane and a part parallel to it by likelihood,
// with a price on the border (a Potts field, iterated conditional modes), while level, slopes and step are
// fitted to both (least squares): heights are level + slope . (u, v), plus the step for samples of the part.
class StepSharing {
 public:
  // `excess`: factor on the noise of means. Samples with the proposal's label take part.
  StepSharing(const RangeImage& image, const RangeNoise& noise, const std::vector<std::uint32_t>& labels,
              const Plane& plane, const StepProposal& proposal, double excess);

  // A part stands out when sharing makes its samples likelier by more than its border costs. It is a step
  // when the heights jump at its border (a wavy wall rises gradually) and are level on both sides of it; it
  // is curved when the surface goes on from it, smoothly, over samples that are on no plane (`is_free`).
  StepVerdict share(const std::function<bool(std::size_t)>& is_free, std::int64_t least);

  template <typename Visit>
  void for_each_of_part(const Visit& visit) const {
    for (const std::uint32_t at : own_)
      if (sides_[at] == kPart) visit(node_of(at));
  }
  double step_m() const { return model_[3]; }
  const MeanHeight& height() const { return height_; }  // of the part over the plane

 private:
  enum Side : std::uint8_t { kStranger, kPlane, kPart };
  struct Sample {
    float height_m = 0, weight = 0, u_m = 0, v_m = 0;
    std::uint8_t ring = 0;  // steps from the border, 1 beside it; 0 = more than a few
  };
  struct Evidence {
    MeanHeight part;  // over the plane given
    MeanHeight inside, outside,
        deep;  // over the plane fitted: part and plane near the border; deep in the part
    double gain = 0, chi2 = 0;
    std::int64_t beside = 0, strays = 0;
  };

  // Of the image, from a place in samples_.
  std::size_t node_of(std::uint32_t at) const {
    return image_.index(top_ - 1 + static_cast<int>(at) / width_, left_ - 1 + static_cast<int>(at) % width_);
  }
  double over_plane(const Sample& s) const {
    return s.height_m - model_[0] - model_[1] * s.u_m - model_[2] * s.v_m;
  }
  double favour(const Sample& sample) const;
  bool is_stray(const Sample& sample) const;
  std::uint32_t neighbour(std::uint32_t at, std::size_t which) const {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(at) + beside_[which]);
  }
  void start_by_windows();
  bool start_by_border(const Plane& border);
  bool settle();
  bool fit(std::int64_t least);
  void measure_rings();
  Evidence weigh() const;
  bool is_sharp(const Evidence& evidence) const;
  bool along_border(const Plane& border, const Evidence& evidence, std::int64_t least) const;
  std::int64_t smooth_rim(const std::function<bool(std::size_t)>& is_free) const;

  const RangeImage& image_;
  Plane plane_;
  std::optional<Plane> border_;
  int top_, left_;         // of the samples shared out
  int width_;              // of samples_: one more on every side, strangers
  std::int64_t proposed_;  // samples
  double sigma_m_;         // along the normal, of a sample of the proposal
  Eigen::Vector4d model_;  // level, slopes, step
  MeanHeight height_;
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> own_;  // those that are no strangers, row by row
  // Of each of samples_: what neighbours are asked for again and again.
  std::vector<Side> sides_;
  std::vector<std::uint8_t> unsettled_;  // it or a neighbour changed sides since it was asked
  std::vector<double> favours_;          // favour(); 0 of strangers
  std::array<std::int32_t, 8> beside_;   // places of the neighbours, from a sample's, row by row
};

}  // namespace hybrid::stages
