#pragma once
#include <embree3/rtcore.h>

#include <filesystem>
#include <optional>

#include "score/geometry.hpp"
#include "score/read/camera.hpp"
#include "score/read/ply_file.hpp"

namespace score {

// Who sees what on the true geometry, traced by Embree. Thread safe.
class TrueMesh {
 public:
  explicit TrueMesh(const PlyContent& mesh);
  ~TrueMesh();
  TrueMesh(const TrueMesh&) = delete;
  TrueMesh& operator=(const TrueMesh&) = delete;

  struct Hit {
    Vec3 point, normal;  // normal: of the triangle, towards the ray's origin
  };
  std::optional<Hit> first_hit(const Vec3& origin, const Vec3& direction) const;

  // The point projects into the camera's image, faces it, and nothing is in between.
  bool sees(const Camera& camera, const Hit& surface) const;

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace score
