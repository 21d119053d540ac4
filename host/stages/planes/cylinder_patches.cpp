#include "stages/planes/cylinder_patches.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.hpp"
#include "stages/planes/cylinders.hpp"

namespace hybrid::stages {
namespace {

// A plane all but whose last samples lie on a cylinder, and that is a small part of it, is a patch of it; so
// is one of a rib along a vault: a ring about the vault's axis goes on at the plane's radius.
constexpr double kPatchShare = 0.9, kMostPatch = 0.15, kPatchTurn = 15 * std::numbers::pi / 180;
constexpr double kRib_m = 0.5;                // from the vault's surface
constexpr int kSectorsAround = 72;            // of 5 degrees
constexpr std::int64_t kFewestInSector = 10;  // samples of a sector that the ring goes through
constexpr int kRingSectors = 12;              // that it must
constexpr std::int64_t kRingLarger = 4;       // times the plane's samples

// What the samples of a plane say of a cylinder that it may be a patch of.
struct Patch {
  const Cylinder* cylinder = nullptr;
  std::int64_t samples = 0, on = 0;
  double distances = 0;                                               // their sum, from the cylinder
  double low = std::numeric_limits<double>::infinity(), high = -low;  // along it
  std::array<std::atomic<std::int64_t>, kSectorsAround>
      ring{};  // samples of no plane that go on at its radius

  bool is_on_it() const { return static_cast<double>(on) >= kPatchShare * static_cast<double>(samples); }
  double off_m() const { return distances / static_cast<double>(samples); }
  bool is_one() const {
    if (samples == 0) return false;
    std::int64_t all = 0;
    int sectors = 0;
    for (const auto& count : ring) {
      all += count;
      sectors += count >= kFewestInSector;
    }
    return is_on_it() || (sectors >= kRingSectors && all >= kRingLarger * samples);
  }
};

int sector_of(const Cylinder& cylinder, const Vec3& point) {
  const Vec3 a = cylinder.axis.unitOrthogonal(), out = cylinder.outwards(point);
  const double turn = std::atan2(out.dot(cylinder.axis.cross(a)), out.dot(a)) / (2 * std::numbers::pi) + 0.5;
  return std::clamp(static_cast<int>(turn * kSectorsAround), 0, kSectorsAround - 1);
}

bool may_be_patch(const Supercluster& plane, const Cylinder& cylinder) {
  const double along = cylinder.along(plane.centroid_m), off = std::abs(cylinder.distance(plane.centroid_m));
  const Vec3 out = cylinder.outwards(plane.centroid_m).normalized();
  const double beyond = cylinder.inside ? kVaultGoesOn_m : 0;
  return static_cast<double>(plane.samples) < kMostPatch * static_cast<double>(cylinder.samples) &&
         along >= -beyond && along <= cylinder.length_m + beyond &&
         off < (cylinder.inside ? kRib_m : 0.1 * cylinder.radius_m) &&
         std::abs(out.dot(plane.plane.normal)) > std::cos(kPatchTurn);
}

// By id, with the cylinder that is nearest to each plane's middle.
std::vector<Patch> patches_of(const RangeImage& image, const RangeNoise& noise,
                              const SuperclusterOptions& options, const PlaneSegmentation& segmentation) {
  const auto& planes = segmentation.superclusters;
  std::vector<Patch> found(planes.size() + 1);
  bool any = false;
  for (const Supercluster& plane : planes)
    for (const Cylinder& cylinder : segmentation.cylinders) {
      const Cylinder*& nearest = found[plane.id].cylinder;
      if (!may_be_patch(plane, cylinder)) continue;
      if (nearest == nullptr ||
          std::abs(cylinder.distance(plane.centroid_m)) < std::abs(nearest->distance(plane.centroid_m)))
        nearest = &cylinder;
      any = true;
    }
  for (std::size_t i = 0; any && i < image.count(); ++i) {
    const std::uint32_t id = segmentation.sample_label[i];
    if (id == 0 || found[id].cylinder == nullptr || image.mask[i] != kMeasured) continue;
    Patch& patch = found[id];
    const Vec3 point = image.point(i);
    const double distance = patch.cylinder->distance(point), along = patch.cylinder->along(point);
    patch.samples += 1;
    patch.on += std::abs(distance) <= cylinder_reach_m(*patch.cylinder, point, noise, options);
    patch.distances += distance;
    patch.low = std::min(patch.low, along);
    patch.high = std::max(patch.high, along);
  }
  return found;
}

// Follows those beside the surface of a vault around its axis.
void follow_rings(const RangeImage& image, const RangeNoise& noise, const SuperclusterOptions& options,
                  const PlaneSegmentation& segmentation, std::vector<Patch>& patches) {
  std::vector<Patch*> ribs;
  for (Patch& patch : patches)
    if (patch.samples > 0 && patch.cylinder->inside && !patch.is_on_it()) ribs.push_back(&patch);
  if (ribs.empty()) return;
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(static_cast<int>(row), col);
      if (image.mask[i] != kMeasured || segmentation.sample_label[i] != 0) continue;
      const Vec3 point = image.point(i);
      for (Patch* patch : ribs) {
        const double along = patch->cylinder->along(point);
        if (along >= patch->low && along <= patch->high &&
            std::abs(patch->cylinder->distance(point) - patch->off_m()) <=
                cylinder_reach_m(*patch->cylinder, point, noise, options))
          ++patch->ring[static_cast<std::size_t>(sector_of(*patch->cylinder, point))];
      }
    }
  });
}

}  // namespace

void forget_planes_on_cylinders(const RangeImage& image, const RangeNoise& noise,
                                const SuperclusterOptions& options, PlaneSegmentation& segmentation) {
  if (segmentation.cylinders.empty()) return;
  auto found = patches_of(image, noise, options, segmentation);
  follow_rings(image, noise, options, segmentation, found);
  auto& planes = segmentation.superclusters;
  std::vector<std::uint32_t> kept, id(found.size());
  for (std::uint32_t old = 1; old < id.size(); ++old)
    if (!found[old].is_one()) kept.push_back(old);
  std::stable_sort(kept.begin(), kept.end(), [&](std::uint32_t a, std::uint32_t b) {
    return planes[a - 1].samples > planes[b - 1].samples;
  });
  if (kept.size() == planes.size() && std::is_sorted(kept.begin(), kept.end())) return;
  std::vector<Supercluster> renumbered;
  for (const std::uint32_t old : kept) {
    renumbered.push_back(std::move(planes[old - 1]));
    id[old] = renumbered.back().id = static_cast<std::uint32_t>(renumbered.size());
  }
  planes = std::move(renumbered);
  parallel_for(
      segmentation.sample_label.size(),
      [&](std::size_t i) { segmentation.sample_label[i] = id[segmentation.sample_label[i]]; }, 1 << 14);
  for (std::size_t i = 0; i < segmentation.square_label.size(); ++i) {
    std::uint32_t& label = segmentation.square_label[i];
    if (label != 0 && id[label] == 0) segmentation.square_class[i] = kPlanarTooSmall;
    label = id[label];
  }
}

}  // namespace hybrid::stages
