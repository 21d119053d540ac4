#include "stages/registration/automatic_decision.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace hybrid::stages {
namespace {

double contradiction(Sight sight, bool spans) {
  switch (sight) {
    case Sight::through:
      return 1;
    case Sight::in_front:
      return spans ? 1 : 0.5;
    case Sight::behind:
      return 0.5;
    case Sight::nothing:
      return 0.05;
    default:
      return 0;
  }
}

// A plane that the other pose lays on its faces too, but for a part.
struct Said {
  double all = 0, through = 0, in_front = 0;
  double shared = 0;  // area that the other pose supports as well
  bool spans = false;
};

}  // namespace

Comparison compare(const std::vector<SightRay>& rays, const std::vector<SightLine>& pose,
                   const std::vector<SightLine>& other) {
  std::vector<Said> by_plane;
  double total = 0, against = 0, recess = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const double area = rays[k].area_m2;
    total += area;
    if (rays[k].plane >= by_plane.size()) by_plane.resize(rays[k].plane + 1);
    if (other[k].sight == Sight::supported) {
      against += area * contradiction(pose[k].sight, rays[k].spans);
      if (pose[k].sight == Sight::through && !rays[k].spans && !other[k].recess) recess += area;
    }
    if (pose[k].sight != Sight::supported) continue;
    Said& said = by_plane[rays[k].plane];
    said.all += area * contradiction(other[k].sight, rays[k].spans);
    said.spans = rays[k].spans;
    if (other[k].sight == Sight::through) said.through += area;
    if (other[k].sight == Sight::in_front) said.in_front += area;
    if (other[k].sight == Sight::supported) said.shared += area;
  }
  Comparison result;
  if (!(total > 0)) return result;
  for (Said& said : by_plane) {
    double firm = said.through;
    if (said.spans || said.shared >= said.in_front) {
      said.all += (1 - contradiction(Sight::in_front, said.spans)) * said.in_front;
      firm += said.in_front;
    }
    result.for_it += said.all / total;
    result.largest = std::max(result.largest, said.all / total);
    result.largest_firm = std::max(result.largest_firm, firm / total);
  }
  result.against_it = against / total;
  result.against_recess = recess / total;
  return result;
}

double strength(const Comparison& c, const MarginRule& rule) {
  const double against = c.against_it - 0.5 * c.against_recess, gap = c.for_it - against,
               consistency = c.for_it + against > 0 ? gap / (c.for_it + against) : 0;
  // What speaks against weighs threefold where a single plane speaks for the pose.
  const double several = (c.without_largest() - against) / rule.least_without_largest;
  const double firm = (c.largest_firm - 3 * against) / rule.least_firm;
  const double single = (c.largest - 3 * against) / rule.least_single;
  return std::min(
      {gap / rule.least_gap, consistency / rule.least_consistency, std::max({several, firm, single})});
}

// A plane right beside a face is a similar room's: clutter seldom lies so.
constexpr double kBeside = 1.5;
// What neither is floor or ceiling nor reaches from one to the other may be furniture, or a recess that the
// model lacks.
constexpr double kClutter = 0.5;

double doubt(const ScanEvidence& scan, const std::vector<SightLine>& pose) {
  Mat3 on = Mat3::Zero(), off = Mat3::Zero();
  double total = 0;
  for (std::size_t k = 0; k < pose.size(); ++k) {
    const SightRay& ray = scan.rays[k];
    total += ray.area_m2;
    if (pose[k].sight == Sight::nothing) continue;
    const Mat3 facing = ray.area_m2 * ray.normal * ray.normal.transpose();
    if (pose[k].sight == Sight::supported)
      on += facing;
    else
      off += (ray.spans ? 1 : kClutter) * (pose[k].sight == Sight::near ? kBeside : 1) * facing;
  }
  // A trace of support in every direction: where nothing supports, the doubt is large, not infinite.
  on += 1e-6 * std::max(total, 1e-300) * Mat3::Identity();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> solver(off, on, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(2);
}

}  // namespace hybrid::stages
