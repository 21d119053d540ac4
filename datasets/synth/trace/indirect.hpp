#pragma once
#include <vector>

#include "surface/patterns.hpp"
#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

// Light that does not come straight from the sun, gathered once at points a step apart on planes and at the
// vertices of curved surfaces, by rays that are the same for all points of a surface (so the error varies
// smoothly, without noise): the sky, panes of glass, and one bounce off what is around. Irradiance over pi.
class IndirectLight {
 public:
  IndirectLight(const World&, const Tracer&, double step_m, int rays);  // keeps references
  Rgb at(const Hit&) const;
  // The sun's own part at a point, `towards` its disc; coloured by a pane in the way.
  Rgb sunlight(const Vec3& point, const Vec3& normal, const Vec3& towards) const;

 private:
  struct Grid {  // over a planar surface; nodes row by row
    double left, bottom, step_u, step_v;
    int columns = 0, rows = 0;
    std::vector<Rgb> nodes;
  };
  bool gather(const Vec3& point, const Vec3& normal, std::uint64_t pattern, Rgb& sum) const;
  Grid gather_grid(std::uint32_t surface) const;
  void gather_vertices();

  const World& world_;
  const Tracer& tracer_;
  double step_m_;
  int rays_;
  std::vector<Grid> grid_of_surface_;
  std::vector<Rgb> vertices_;
};

}  // namespace synth
