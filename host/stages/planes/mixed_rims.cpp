#include "stages/planes/mixed_rims.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

// Samples nearer to each other than this are met by one beam, more or less: a beam is 3 to 6 mm wide where it
// leaves the scanner.
constexpr double kBeam_m = 0.0075;
constexpr double kJump_m = 0.01;  // less leaves a beam's mean within most scanners' noise
constexpr int kFewestRounds = 2, kMostRounds = 6;
constexpr double kRoom_m = 4;  // a range for which the rounds, of a sample each, go as far as half a beam
// At a jump, how likely a sample is mixed, as odds: their logarithm rises by kByLean for each standard
// deviation that it leans to the surface beyond, by kByAway for the square of those it lies to the other side
// (where a third surface is), and falls by kByJump with each doubling of a jump beyond kTolerances: mixed
// samples then seldom lie within the plane's tolerance at all. Logistic regression on the nave of
// hybrid-synth's church, seed 3, 20 MP (seed 4: the same shares), where the beam is wider than the spacing;
// where it is narrower, it meets fewer of the rims.
constexpr double kOdds = -1.3, kByLean = 1.13, kByAway = 0.144, kByJump = 0.87, kTolerances = 2;
constexpr double kFewestOfScatter = 30;  // samples
constexpr double kMostLean = 4, kLeastRimCosine = 0.05;
// At a crease, where another surface takes over within half a beam: how far that one is from the plane there.
// 77 of 100 that lose their label are mixed (the same scan).
constexpr double kAtCrease_m = 0.012;
// Of a small plane's samples, those with none of another surface beside them; fewer of them are a strip where
// the plane is seen from the side, as that through mixed samples is.
constexpr double kLeastInsideSteep = 0.1, kLeastInsideGrazing = 0.5, kGrazing = 0.1;
constexpr std::int64_t kFewestInside = 128;

class Strips {
 public:
  Strips(const RangeImage& image, const std::vector<Plane>& planes, const PlaneRegions& regions,
         const std::vector<std::uint32_t>& labels)
      : image_(image),
        planes_(planes),
        regions_(regions),
        labels_(labels),
        crossings_(image, planes, regions, labels),
        step_rad_(image.step_rad()) {}

  // Of a row's samples on small planes, by label.
  struct Inside {
    std::int64_t samples = 0, inside = 0;
    double cosines = 0;  // of incidence, their sum

    void add(const Inside& other) {
      samples += other.samples;
      inside += other.inside;
      cosines += other.cosines;
    }
    bool is_strip() const {
      const auto all = static_cast<double>(samples), share = static_cast<double>(inside) / all;
      return share < kLeastInsideSteep ||
             (cosines < kGrazing * all && share < kLeastInsideGrazing && inside < kFewestInside);
    }
  };
  void count_inside(int row, std::map<std::uint32_t, Inside>& of) const {
    for (int col = 0; col < image_.cols; ++col) {
      const std::size_t i = image_.index(row, col);
      const std::uint32_t label = labels_[i];
      if (label == 0 || !regions_.regions[label - 1].small) continue;
      bool inside = true;
      for (int direction = 0; direction < 4; ++direction) {
        const auto other = crossings_.node(row + (direction == 0) - (direction == 1),
                                           col + (direction == 2) - (direction == 3));
        inside &= !other || labels_[*other] == label || image_.mask[*other] == kEmpty;
      }
      Inside& count = of[label];
      const Vec3 point = image_.point(i);
      const double range = point.norm();
      count.add(
          {1, inside || step_rad_ * range > kBeam_m, std::abs(planes_[label - 1].normal.dot(point)) / range});
    }
  }

 private:
  const RangeImage& image_;
  const std::vector<Plane>& planes_;
  const PlaneRegions& regions_;
  const std::vector<std::uint32_t>& labels_;
  RimCrossings crossings_;
  double step_rad_;
};

// Strips hardly wider than a beam, between the surfaces that their beams met.
std::vector<std::int64_t> drop_mixed_strips(const RangeImage& image, const std::vector<Plane>& planes,
                                            const PlaneRegions& regions, std::vector<std::uint32_t>& labels) {
  const Strips finder(image, planes, regions, labels);
  std::vector<std::map<std::uint32_t, Strips::Inside>> of_row(static_cast<std::size_t>(image.rows));
  parallel_for(of_row.size(),
               [&](std::size_t row) { finder.count_inside(static_cast<int>(row), of_row[row]); });
  std::vector<Strips::Inside> of(planes.size() + 1);
  for (const auto& row : of_row)
    for (const auto& [label, count] : row) {
      of[label].add(count);
    }
  std::vector<std::int64_t> lost(of.size());
  for (std::size_t label = 1; label < of.size(); ++label)
    if (of[label].is_strip()) lost[label] = of[label].samples;
  for (std::uint32_t& label : labels)
    if (lost[label] > 0) label = 0;
  return lost;
}

// By label: how far its samples inside lie from its plane, in standard deviations of noise, root mean square;
// more than 1 where a wall strays from its plane, and at least that. Of a large image some rows say it.
std::vector<double> scatter_of_planes(const RangeImage& image, const RangeNoise& noise,
                                      const RimCrossings& crossings, const std::vector<std::uint32_t>& labels,
                                      std::size_t planes) {
  constexpr int kRowsOfScatter = 512;
  const int every = std::max(1, image.rows / kRowsOfScatter);
  std::vector<std::map<std::uint32_t, std::pair<double, double>>> of_row(
      static_cast<std::size_t>((image.rows + every - 1) / every));
  parallel_for(of_row.size(), [&](std::size_t k) {
    const int row = static_cast<int>(k) * every;
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (!crossings.on_plane(i) || !crossings.is_inside(row, col)) continue;
      const auto off = crossings.behind_m(crossings.plane(i), i);
      if (!off) continue;
      const double sigmas = *off / noise.at(image.point(i).norm(), crossings.cosine(i));
      auto& [squares, samples] = of_row[k][labels[i]];
      squares += std::min(sigmas * sigmas, kMostLean * kMostLean);
      samples += 1;
    }
  });
  std::vector<double> squares(planes + 1), samples(planes + 1), scatter(planes + 1, 1);
  for (const auto& row : of_row)
    for (const auto& [label, sum] : row) {
      squares[label] += sum.first;
      samples[label] += sum.second;
    }
  for (std::size_t label = 0; label <= planes; ++label)
    if (samples[label] >= kFewestOfScatter)
      scatter[label] = std::max(1.0, std::sqrt(squares[label] / samples[label]));
  return scatter;
}

// Whether the beams of samples at rims met two surfaces.
class MixedSamples {
 public:
  MixedSamples(const RangeImage& image, const RangeNoise& noise, const BeamWidth& beam,
               const RimTolerance& tolerance, const RimCrossings& crossings,
               const std::vector<std::uint32_t>& labels, std::size_t planes)
      : image_(image),
        noise_(noise),
        beam_(beam),
        tolerance_(tolerance),
        crossings_(crossings),
        labels_(labels),
        scatter_(scatter_of_planes(image, noise, crossings, labels, planes)) {}

  bool is_mixed(int row, int col) const {
    for (int direction = 0; direction < 4; ++direction) {
      const int row_step = (direction == 0) - (direction == 1),
                col_step = (direction == 2) - (direction == 3);
      const auto crossing = crossings_.cross(row, col, row_step, col_step);
      if (!crossing) continue;
      const std::size_t i = image_.index(row, col);
      if (crossing->is_crease() ? at_crease(i, col_step, *crossing) : at_jump(i, col_step, *crossing))
        return true;
    }
    return false;
  }

 private:
  double beam_nodes(std::size_t i, int col_step) const {
    return beam_.at(image_.point(i).norm()) / crossings_.spacing_m(i, col_step);
  }

  bool at_crease(std::size_t i, int col_step, const RimCrossing& crossing) const {
    if (!crossing.to_plane) return false;
    const double here = std::abs(crossing.behind_here_m), there = std::abs(crossing.behind_there_m);
    const double nodes = crossing.gap + 1, to_crease = nodes * there / (here + there);
    const double half_beam = beam_nodes(i, col_step) / 2;
    return (half_beam - to_crease) * (here + there) / nodes > kAtCrease_m;
  }

  bool at_jump(std::size_t i, int col_step, const RimCrossing& crossing) const {
    const double jump = crossing.jump_m();
    const auto off = crossings_.behind_m(crossings_.plane(i), i);
    if (std::abs(jump) < kJump_m || !off) return false;
    const double cosine = std::max(crossings_.cosine(i), kLeastRimCosine);
    const double sigma = noise_.at(image_.point(i).norm(), crossings_.cosine(i));
    const double tolerance = tolerance_.sigmas * sigma + tolerance_.waviness_m / cosine;
    const double lean =
        std::clamp((jump > 0 ? *off : -*off) / (sigma * scatter_[labels_[i]]), -kMostLean, kMostLean);
    return kOdds + std::log(std::min(1.0, beam_nodes(i, col_step))) +
               (lean > 0 ? kByLean * lean : kByAway * lean * lean) >
           kByJump * std::max(0.0, std::log2(std::abs(jump) / (kTolerances * tolerance)));
  }

  const RangeImage& image_;
  const RangeNoise& noise_;
  const BeamWidth& beam_;
  const RimTolerance& tolerance_;
  const RimCrossings& crossings_;
  const std::vector<std::uint32_t>& labels_;
  std::vector<double> scatter_;
};

// Samples that may look across a node: what it has become may make them mixed.
void ask_around(const RangeImage& image, const RimCrossings& crossings, std::size_t i,
                std::vector<bool>& asked) {
  const int row = static_cast<int>(i) / image.cols, col = static_cast<int>(i) % image.cols;
  for (int away = -RimCrossings::kMostReach; away <= RimCrossings::kMostReach; ++away)
    for (const auto& node : {crossings.node(row + away, col), crossings.node(row, col + away)})
      if (node) asked[*node] = true;
}

}  // namespace

std::vector<std::int64_t> trim_mixed_rims(const RangeImage& image, const RangeNoise& noise,
                                          const BeamWidth& beam, const RimTolerance& tolerance,
                                          const std::vector<Plane>& planes, const PlaneRegions& regions,
                                          std::vector<std::uint32_t>& labels) {
  std::vector<std::int64_t> lost = drop_mixed_strips(image, planes, regions, labels);
  if (!(beam.at(kRoom_m) > 0)) return lost;
  const RimCrossings crossings(image, planes, regions, labels);
  const MixedSamples mixed(image, noise, beam, tolerance, crossings, labels, planes.size());
  const double half_beam = beam.at(kRoom_m) / 2 / (image.step_rad() * kRoom_m);
  const int rounds = std::clamp(static_cast<int>(std::ceil(half_beam)), kFewestRounds, kMostRounds);
  std::vector<bool> asked(labels.size());  // in the next round
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::vector<std::size_t>> of_row(static_cast<std::size_t>(image.rows));
    parallel_for(of_row.size(), [&](std::size_t row) {
      for (int col = 0; col < image.cols; ++col) {
        const std::size_t i = image.index(static_cast<int>(row), col);
        if ((round == 0 || asked[i]) && crossings.on_plane(i) &&
            !crossings.is_inside(static_cast<int>(row), col) && mixed.is_mixed(static_cast<int>(row), col))
          of_row[row].push_back(i);
      }
    });
    asked.assign(asked.size(), false);
    for (const auto& row : of_row)
      for (const std::size_t i : row) {
        lost[labels[i]] += 1;
        labels[i] = 0;
        ask_around(image, crossings, i, asked);
      }
  }
  return lost;
}

}  // namespace hybrid::stages
