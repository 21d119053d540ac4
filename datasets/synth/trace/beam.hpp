#pragma once
#include <optional>

#include "geometry/random.hpp"
#include "trace/scanner.hpp"

namespace synth {

inline constexpr double kBeamRadiusM = 0.003;    // at the mirror
inline constexpr double kBeamSpreadRad = 0.001;  // half angle

struct Return {
  double range_m, true_range_m, reflectance;
  std::uint32_t plane_id;
  SampleKind kind;
  double tan_incidence = 0;
};

// One laser beam's way: the surfaces in its footprint, and with `optics` what dark, glossy and glass ones do.
struct Beam {
  const World& world;
  const Tracer& tracer;
  Vec3 mirror;  // world
  bool optics;

  // Nothing: no return. `chance` is drawn from only with optics.
  std::optional<Return> measure(const Vec3& direction, Random& chance) const;

 private:
  double reflectance(const Hit&, const Vec3& direction) const;
  std::optional<Return> on_solid(const Hit& centre, const Vec3& direction) const;
  std::optional<Return> at_glass(const Hit& pane, const Vec3& direction, Random& chance) const;
  bool lost(const Hit&, const Vec3& direction, double strength, Random& chance) const;
};

}  // namespace synth
