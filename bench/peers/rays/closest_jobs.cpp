#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "cases/closest_point_tree_case.hpp"
#include "rays/embree_rays.hpp"
#include "rays/rays_jobs.hpp"
#include "shared/proxy_obj.hpp"

namespace hybrid::peers {
namespace {

using testing::ClosestPointCase;

constexpr std::size_t kTargetPoints = 1'000'000;

struct Cloud {
  const std::vector<Eigen::Vector3f>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;

// The model relative to the queries' origin, as the kernel gets it.
ProxyMesh mesh_of(const ClosestPointCase::Input& in) {
  ProxyMesh mesh;
  for (const auto& v : in.model.vertices) mesh.vertices.push_back(v - in.origin);
  for (const auto& t : triangulate(in.model))
    mesh.triangles.push_back({t.vertices[0], t.vertices[1], t.vertices[2]});
  return mesh;
}

Geometry geometry_of(const ProxyMesh& mesh) {
  Geometry geometry;
  for (const auto& triangle : mesh.triangles) {
    for (std::uint32_t corner : triangle)
      for (int k = 0; k < 3; ++k) geometry.corners.push_back(static_cast<float>(mesh.vertices[corner][k]));
    geometry.ids.push_back(static_cast<std::uint32_t>(geometry.ids.size()) + 1);
  }
  return geometry;
}

std::vector<float> moved(const ClosestPointCase::Input& in) {
  std::vector<float> queries;
  for (std::size_t i = 0; i < in.x.size(); ++i) {
    const Vec3 p = in.local_from_scan * Vec3(in.x[i], in.y[i], in.z[i]);
    for (int k = 0; k < 3; ++k) queries.push_back(static_cast<float>(p[k]));
  }
  return queries;
}

// Largest and median difference where both found something.
std::string apart(const std::vector<float>& ours, const std::vector<float>& theirs) {
  std::vector<float> differences;
  for (std::size_t i = 0; i < ours.size(); ++i)
    if (std::isfinite(ours[i]) && std::isfinite(theirs[i]))
      differences.push_back(std::abs(ours[i] - theirs[i]));
  if (differences.empty()) return "nothing in common with ours";
  std::sort(differences.begin(), differences.end());
  return fmt::format("distance {:.4f} mm from ours (median), {:.3f} mm (largest)",
                     1000 * differences[differences.size() / 2], 1000 * differences.back());
}

// A mesh as large as a scanned one: our tree against Embree's.
void mesh_jobs(device::Queue& queue, std::size_t count, const RayOptions& options,
               nlohmann::ordered_json& rows) {
  using testing::ClosestPointTreeCase;
  auto input = ClosestPointTreeCase::make(count, 1, 33);
  input.normal_deg = 180;
  const EmbreeScene scene(geometry_of(mesh_of(input)));
  const Stopwatch building;
  const auto tree = stages::make_proxy_tree(stages::proxy_triangles(input.model, input.origin));
  const std::string built = fmt::format(
      "kernel time; distance, face and point written; tree built before in {:.2f} s", building.seconds());
  const auto queries = moved(input);
  std::vector<float> ours, theirs;
  for (const float radius : {INFINITY, 0.5f}) {
    input.gate_m = radius;
    measure(std::isinf(radius) ? "closest point" : "closest point within 50 cm",
            fmt::format("{} queries in scan order, {} triangles", count, tree.triangles.size()),
            static_cast<double>(count), options.rounds,
            {{"hybrid closest_point_tree",
              "hybrid",
              built,
              true,
              [&] {
                return kernel_seconds(queue, "closest_point_tree",
                                      [&] { ours = ClosestPointTreeCase::run(queue, input, tree).distance; });
              },
              {}},
             {"Embree point query", "Embree " RTC_VERSION_STRING, "callback per triangle; distance written",
              false, [&] { return spent_on([&] { scene.closest(queries, radius, theirs); }); },
              [&] { return apart(ours, theirs); }}},
            rows);
  }
}

}  // namespace

void closest_jobs(device::Queue& queue, const RayOptions& options, nlohmann::ordered_json& rows) {
  if (std::string("queries").find(options.only) == std::string::npos) return;
  const std::size_t count = options.quick ? 100'000 : 1'000'000;
  auto input = ClosestPointCase::make(count, 1);
  input.normal_deg = 180;  // peers know no normals
  const ProxyMesh mesh = mesh_of(input);
  const EmbreeScene scene(geometry_of(mesh));
  const auto queries = moved(input);
  const SampledProxy sampled = sample_proxy(mesh, kTargetPoints);
  const Cloud cloud{sampled.points};
  const Stopwatch building;
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  const std::string built = fmt::format(
      "nearest of 1 M points on the triangles; tree built before in {:.2f} s", building.seconds());
  std::vector<float> ours, theirs;
  for (const float radius : {INFINITY, 0.5f}) {
    input.gate_m = radius;
    std::vector<Contender> contenders = {
        {"hybrid closest_point",
         "hybrid",
         "kernel time; distance, face and point written",
         true,
         [&] {
           return kernel_seconds(queue, "closest_point",
                                 [&] { ours = ClosestPointCase::run(queue, input).distance; });
         },
         {}},
        {"Embree point query", "Embree " RTC_VERSION_STRING, "callback per triangle; distance written", false,
         [&] { return spent_on([&] { scene.closest(queries, radius, theirs); }); },
         [&] { return apart(ours, theirs); }}};
    if (std::isinf(radius))
      contenders.push_back({"nanoflann", "nanoflann", built, false,
                            [&] {
                              return spent_on([&] {
                                theirs.resize(count);
#pragma omp parallel for schedule(dynamic, 4096)
                                for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i) {
                                  const float* p = queries.data() + 3 * i;
                                  std::uint32_t nearest = 0;
                                  float distance2 = INFINITY;
                                  if (std::isfinite(p[0])) tree.knnSearch(p, 1, &nearest, &distance2);
                                  theirs[static_cast<std::size_t>(i)] = std::sqrt(distance2);
                                }
                              });
                            },
                            [&] { return apart(ours, theirs); }});
    measure(std::isinf(radius) ? "closest point" : "closest point within 50 cm",
            fmt::format("{} queries in scan order, 180 triangles", count), static_cast<double>(count),
            options.rounds, contenders, rows);
  }
  mesh_jobs(queue, count, options, rows);
}

}  // namespace hybrid::peers
