#pragma once
#include <memory>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "stages/registration/automatic_scene.hpp"
#include "stages/registration/proxy_tree.hpp"
#include "stages/rendering/bvh.hpp"

namespace hybrid::stages {

// From this many triangles on they are searched by a tree, below one after the other. Measured (hybrid-bench
// --only closest): with 24 the tree takes 1.3 times brute force's time, with 48 and 180 about 0.6 of it.
inline constexpr std::size_t kTreeFrom = 32;

// The proxy as registration asks for it. What is made of its polygons, shapes and trees, is made once, when
// it is first asked for, for all scans and steps: from any thread. Throws what measure_model(),
// proxy_triangles() and build_bvh() throw.
class ProxyModel {
 public:
  // `polygons` must outlive it and stay as it is.
  ProxyModel(const PolygonModel& polygons);  // implicit: who registers once has no use for it
  ~ProxyModel();

  const PolygonModel& polygons() const { return polygons_; }
  const ModelShapes& shapes() const;

  // Motions that take much of the model onto itself, about the world's origin: near-symmetries, each of which
  // makes a rival of a pose. `levelled`: turns about the vertical alone.
  const std::vector<Pose>& motions(bool levelled) const;

  // The triangles of proxy_triangles() about an origin. From kTreeFrom on in a tree; below without nodes,
  // root BVH_EMPTY, in the order of triangulate(). The tree's boxes are the origin's own, their order is not.
  ProxyTree tree_at(const Vec3& origin) const;

  // What lines of sight are traced through: triangles with id 1 + face about `origin`, the middle of the
  // model.
  struct Sights {
    Vec3 origin;
    Bvh bvh;
  };
  const Sights& sights() const;

 private:
  struct Made;
  const PolygonModel& polygons_;
  std::unique_ptr<Made> made_;
};

}  // namespace hybrid::stages
