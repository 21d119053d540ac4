#include "stages/registration/proxy_model.hpp"

#include <array>
#include <mutex>

#include "core/parallel.hpp"
#include "stages/registration/automatic_search.hpp"
#include "stages/registration/proxy_triangles.hpp"

namespace hybrid::stages {
namespace {

Vec3 middle_of(const PolygonModel& model) {
  Eigen::AlignedBox3d box;
  for (const Face& face : model.faces)
    for (const std::uint32_t v : face.outer) box.extend(model.vertices[v]);
  return box.center();
}

std::vector<TriangleRecord> corners_of(const PolygonModel& model, const std::vector<Triangle>& triangles,
                                       const Vec3& origin) {
  std::vector<TriangleRecord> records(triangles.size());
  const auto store = [&](std::uint32_t vertex, float* to) {
    const Vec3 position = model.vertices[vertex] - origin;
    for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(position(k));
  };
  parallel_for(
      triangles.size(),
      [&](std::size_t i) {
        store(triangles[i].vertices[0], records[i].a);
        store(triangles[i].vertices[1], records[i].b);
        store(triangles[i].vertices[2], records[i].c);
        records[i].id = 1 + triangles[i].face;
      },
      kTriangleBatch);
  return records;
}

}  // namespace

struct ProxyModel::Made {
  std::once_flag once_shapes, once_facets, once_sights;
  std::array<std::once_flag, 2> once_motions;  // of any, of levelled scanners
  std::array<std::vector<Pose>, 2> motions;
  ModelShapes shapes;
  ProxyFacets facets;  // in the order of the tree's leaves where there is a tree
  ProxyTreePlan plan;
  Sights sights;
};

ProxyModel::ProxyModel(const PolygonModel& polygons) : polygons_(polygons), made_(std::make_unique<Made>()) {}
ProxyModel::~ProxyModel() = default;

const ModelShapes& ProxyModel::shapes() const {
  std::call_once(made_->once_shapes, [&] { made_->shapes = measure_model(polygons_); });
  return made_->shapes;
}

const std::vector<Pose>& ProxyModel::motions(bool levelled) const {
  const std::size_t which = levelled ? 1 : 0;
  std::call_once(made_->once_motions[which],
                 [&] { made_->motions[which] = motions_onto_itself(shapes(), levelled); });
  return made_->motions[which];
}

ProxyTree ProxyModel::tree_at(const Vec3& origin) const {
  std::call_once(made_->once_facets, [&] {
    ProxyFacets facets = proxy_facets(polygons_);
    if (facets.triangles.size() >= kTreeFrom) {
      const auto corners = corners_of(polygons_, facets.triangles, middle_of(polygons_));
      made_->plan = plan_proxy_tree(build_binary_tree(corners, {}));
      std::vector<Triangle> ordered(facets.triangles.size());
      parallel_for(
          ordered.size(), [&](std::size_t i) { ordered[i] = facets.triangles[made_->plan.order[i]]; },
          kTriangleBatch);
      facets.triangles = std::move(ordered);
    }
    made_->facets = std::move(facets);
  });
  return make_proxy_tree(made_->plan, proxy_triangles(polygons_, made_->facets, origin));
}

const ProxyModel::Sights& ProxyModel::sights() const {
  std::call_once(made_->once_sights, [&] {
    const auto triangles = triangulate(polygons_);  // checks the polygons, too
    const Vec3 origin = middle_of(polygons_);
    made_->sights = {origin, build_bvh(corners_of(polygons_, triangles, origin), {})};
  });
  return made_->sights;
}

}  // namespace hybrid::stages
