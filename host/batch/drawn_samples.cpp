#include "batch/drawn_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel_blocks.hpp"
#include "stages/rendering/column_backs.hpp"
#include "stages/rendering/column_ends.hpp"
#include "stages/rendering/far_flanks.hpp"
#include "stages/rendering/opening_contents.hpp"
#include "stages/rendering/shadow_faces.hpp"

namespace hybrid::batch {
namespace {

constexpr double kOnPolygonDeg = 30;  // normals of a sample's plane and of a polygon it lies on
constexpr double kNoiseSigmas = 3;    // of the difference of two scans
constexpr double kSightTolerance_m = 0.02;
constexpr double kFiner = 2;  // times closer together are the samples of another scan that stand for one
constexpr double kSeenThrough_m = 0.1;  // by which another scan sees past a sample that is in the air

// Of a block of nodes.
struct ChosenSamples {
  DrawnCounts counts;
  std::vector<stages::RadiusLimit> radius_limits;

  ChosenSamples& operator+=(const ChosenSamples& next) {
    counts += next.counts;
    radius_limits.insert(radius_limits.end(), next.radius_limits.begin(), next.radius_limits.end());
    return *this;
  }
};

double largest_sigma(const std::vector<ScanProduct>& products) {
  double sigma_m = 0;
  for (const auto& product : products) sigma_m = std::max(sigma_m, product.sigma_m);
  return sigma_m;
}

// Of vertices that follow `by` others.
Face shifted(Face face, std::uint32_t by) {
  for (std::uint32_t& vertex : face.outer) vertex += by;
  for (auto& hole : face.holes)
    for (std::uint32_t& vertex : hole) vertex += by;
  return face;
}

// What the scans' evidence says of sides and places that none of them has seen.
void append_unseen(const stages::ScanSight& sight, const std::vector<ScanProduct>& products,
                   const std::vector<std::optional<ScanRegistration>>& registrations,
                   const std::vector<stages::GlazedOpening>& openings, const PolygonModel& model,
                   WorldContours& all) {
  std::vector<std::uint32_t> product_of;
  std::vector<std::size_t> scan_of(products.size());
  for (std::size_t i = 0; i < products.size(); ++i) {
    scan_of[i] = product_of.size();
    if (registrations[i]) product_of.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::size_t> scan_of_face;
  for (const std::uint32_t product : all.scan) scan_of_face.push_back(scan_of[product]);
  const auto ends = stages::column_ends(sight, all.model);
  const auto shadows = stages::shadow_faces(sight, all.model, scan_of_face, model);
  const auto contents = stages::opening_contents(sight, all.model, openings);
  std::vector<std::size_t> part_of(all.model.faces.size());
  std::iota(part_of.begin(), part_of.end(), std::size_t{0});
  const auto add = [&](std::size_t scan, std::string name, const Face& face, const auto& vertices) {
    const auto shift = static_cast<std::uint32_t>(all.model.vertices.size());
    all.model.faces.push_back(shifted(face, shift));
    all.model.faces.back().name = std::move(name);
    all.model.vertices.insert(all.model.vertices.end(), vertices.begin(), vertices.end());
    all.scan.push_back(product_of[scan]);
  };
  const auto column = [&](std::size_t scan, std::uint32_t cylinder) {
    return fmt::format("{}-column-{}", products[product_of[scan]].id, cylinder);
  };
  const Face quadrilateral{"", {0, 1, 2, 3}, {}};
  for (const stages::ColumnBack& back : stages::column_backs(sight))
    add(back.scan, column(back.scan, back.cylinder), quadrilateral, back.corners);
  for (const auto& [scan, cylinder, polygon] : ends)
    add(scan, column(scan, cylinder), polygon.faces[0], polygon.vertices);
  for (const auto& [kind, face, polygon] : contents) {
    const char* what = kind == stages::OpeningContent::Kind::back ? "-back" : "-alike";
    add(scan_of_face[face], all.model.faces[face].name + what, polygon.faces[0], polygon.vertices);
  }
  part_of.resize(all.model.faces.size(), stages::kPartOfNone);
  for (const auto& [face, polygon] : shadows) {
    add(scan_of_face[face], all.model.faces[face].name + "-shadow", polygon.faces[0], polygon.vertices);
    part_of.push_back(face);
  }
  for (const auto& [face, corners] : stages::far_flanks(sight, all.model, part_of))
    add(scan_of_face[face], all.model.faces[face].name + "-flank", quadrilateral, corners);
}

}  // namespace

std::vector<stages::SightScan> sight_scans(
    const std::vector<ScanProduct>& products,
    const std::vector<std::optional<ScanRegistration>>& registrations) {
  std::vector<stages::SightScan> scans;
  for (std::size_t i = 0; i < products.size(); ++i)
    if (registrations[i])
      scans.push_back({&products[i].image, &products[i].segmentation.sample_label, &products[i].stray,
                       registrations[i]->world_from_scan(), &products[i].segmentation.cylinders});
  return scans;
}

WorldContours world_contours(const std::vector<ScanProduct>& products,
                             const std::vector<std::optional<ScanRegistration>>& registrations) {
  WorldContours all;
  for (std::size_t i = 0; i < products.size(); ++i) {
    if (!registrations[i]) continue;
    const auto& own = products[i].contour_faces;
    const auto shift = static_cast<std::uint32_t>(all.model.vertices.size());
    for (const Vec3& vertex : own.model.vertices)
      all.model.vertices.push_back(registrations[i]->world_from_scan() * vertex);
    for (std::size_t k = 0; k < own.model.faces.size(); ++k) {
      all.model.faces.push_back(shifted(own.model.faces[k], shift));
      all.model.faces.back().name = fmt::format("{}-{}", products[i].id, own.supercluster[k]);
      all.scan.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return all;
}

WorldContours choose_drawn_samples(device::Queue& queue, const StageOptions& options,
                                   const std::vector<std::optional<ScanRegistration>>& registrations,
                                   const std::vector<stages::GlazedOpening>& openings,
                                   const PolygonModel& model, std::vector<ScanProduct>& products) {
  WorldContours contours = world_contours(products, registrations);
  const double worst_sigma_m = largest_sigma(products);
  const auto scans = sight_scans(products, registrations);
  const stages::ScanSight sight(scans, kSightTolerance_m);
  if (options.render.unseen_m > 0) append_unseen(sight, products, registrations, openings, model, contours);
  std::size_t scan = 0;
  for (std::size_t p = 0; p < products.size(); ++p) {
    if (!registrations[p]) continue;
    auto& product = products[p];
    const auto near =
        static_cast<float>(std::min(kNoiseSigmas * std::hypot(product.sigma_m, worst_sigma_m), kFreeReach_m));
    std::vector<std::uint8_t> retained(product.image.count());
    parallel_for(
        retained.size(),
        [&](std::size_t i) {
          retained[i] = product.decimation.fate[i] > stages::kDiscarded &&
                        product.stray[i] == stages::kNotStray &&
                        (product.contour_faces.covered.empty() || !product.contour_faces.covered[i]);
        },
        1 << 14);
    std::vector<std::uint8_t> on_contour;
    if (!contours.model.faces.empty())
      on_contour = stages::near_faces(queue, product.image, product.segmentation, contours.model,
                                      registrations[p]->world_from_scan(), kOnPolygonDeg, {near}, retained);
    const auto& to_face = registrations[p]->signed_distance_m;
    const double through_m = kSeenThrough_m + kNoiseSigmas * worst_sigma_m;
    const double step_rad = product.image.step_rad();
    const auto& world = registrations[p]->world_from_scan();
    product.drawn.assign(product.image.count(), stages::kNotDrawn);
    auto chosen = sum_blocks<ChosenSamples>(product.image.count(), [&](std::size_t begin, std::size_t end) {
      ChosenSamples block;
      DrawnCounts& counts = block.counts;
      for (std::size_t i = begin; i < end; ++i) {
        if (!retained[i]) continue;
        counts.retained += 1;
        if (!on_contour.empty() && on_contour[i]) {
          counts.on_contours += 1;
          continue;
        }
        const bool planar = product.segmentation.sample_label[i] != 0;
        const Vec3 point = product.image.point(i);
        if (!planar && sight.is_seen_through(world * point, through_m, step_rad * point.norm(), scan)) {
          counts.in_the_air += 1;
          continue;
        }
        const auto finer = sight.seen_finer(world * point, scan, kFiner, through_m);
        if (finer && !finer->at_edge) {
          counts.seen_finer += 1;
          continue;
        }
        if (finer)
          block.radius_limits.push_back(
              {static_cast<std::uint32_t>(i), static_cast<float>(finer->spacing_m / world.scale)});
        const bool on_face = !to_face.empty() &&
                             std::abs(to_face[i]) <= (planar ? static_cast<float>(options.explain_m) : near);
        counts.on_faces += on_face;
        product.drawn[i] = on_face ? stages::kDrawnOffFaces : stages::kDrawn;
      }
      return block;
    });
    product.drawn_counts = chosen.counts;
    product.radius_limits = std::move(chosen.radius_limits);
    ++scan;
  }
  return contours;
}

}  // namespace hybrid::batch
