#pragma once
#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

// Plain C++ and Embree, without anything of ours but the numbers handed in: three floats a vertex, no classes
// of host/. What a graphics programmer would write first, with Embree's rays in either of its modes.
namespace hybrid::peers {

enum class RayMode { single, packet16 };

struct Pinhole {
  float rotation[9], centre[3];  // cam_from_world, row-major
  float fx, fy, cx, cy, k1;      // k1: first radial term
  int width, height;
};

struct Geometry {
  std::vector<float> corners;      // 9 per triangle
  std::vector<std::uint32_t> ids;  // per triangle
  std::vector<float> spheres;      // centre and radius, 4 per sphere
};

// What primary rays give: as our ray_cast kernel writes it, planes of `count` floats.
struct Surface {
  std::size_t count = 0;
  std::vector<float> distance, point,
      normal;                     // 1, 3 and 3 per pixel, pixel after pixel; distance inf = nothing
  std::vector<std::uint32_t> id;  // 0 = nothing
};

class EmbreeScene {
 public:
  explicit EmbreeScene(const Geometry& geometry);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void cast(const Pinhole& camera, RayMode mode, Surface& out) const;

  // Rays from every surface point to the centre of every camera: how many are free.
  std::size_t shadow(const Surface& surface, const std::vector<Pinhole>& cameras, RayMode mode) const;

  struct Photographs {
    std::vector<Pinhole> cameras;
    const std::uint8_t* pixels = nullptr;  // RGBA, the same for all, as in our bench
    const std::uint16_t* low = nullptr;    // RGBA halves: the low band
    const float* linear = nullptr;         // light of an sRGB byte
    float eye[3] = {0, 0, 0}, pixel_rad = 0, feather_px = 0;
  };
  // Every photograph projected on every surface point that it sees: weights 1 / (angle + one pixel),
  // feathered at the border; low bands by weight, high bands by weight to the eighth. sums: 8 floats per
  // pixel; seen: photographs; both start at 0.
  void blend(const Surface& surface, const Photographs& photographs, RayMode mode, std::vector<float>& sums,
             std::vector<std::uint32_t>& seen) const;

  // Distance of every query (3 floats each) to the triangles, inf beyond radius_m.
  void closest(const std::vector<float>& queries, float radius_m, std::vector<float>& distance) const;

 private:
  void free_rays(const Surface& surface, std::size_t first, int lanes, const float centre[3], RayMode mode,
                 int valid[16]) const;

  RTCDevice device_;
  RTCScene scene_;
  std::vector<float> corners_;
  std::vector<std::uint32_t> ids_;
  unsigned spheres_geometry_ = RTC_INVALID_GEOMETRY_ID;
};

}  // namespace hybrid::peers
