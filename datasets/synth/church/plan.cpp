#include <cmath>
#include <numbers>

#include "church/church.hpp"

namespace synth {

Plan draw_plan(std::uint64_t seed) {
  Random random(seed, purpose::layout);
  const auto vary = [&](double low, double high) { return random.uniform(low, high); };
  Plan p{};
  p.half_width = vary(5.2, 5.9);
  p.bays = 3 + static_cast<int>(vary(0, 2));
  p.length = p.bays * vary(3.9, 4.4);
  p.wall = vary(0.85, 0.95);
  p.aisle_ceiling = vary(5.9, 6.3);
  p.arcade = vary(2.95, 3.2);
  p.arcade_thick = vary(0.5, 0.58);
  p.springing = vary(3.1, 3.4);
  p.arch_sharpness = vary(0, 1) < 0.3 ? 0.5 : vary(0.75, 1.0);
  p.vault_springing = p.aisle_ceiling + vary(0.3, 0.5);
  p.vaulted = vary(0, 1) < 0.7;
  p.eaves = p.aisle_ceiling + vary(0.45, 0.6);
  p.ridge = p.eaves + p.outer_half() * vary(0.88, 1.0);
  p.portal_half = vary(1.4, 1.55);
  p.portal_springing = vary(2.35, 2.55);
  p.portal_depth[0] = vary(0.24, 0.3);
  p.portal_depth[1] = vary(0.22, 0.28);
  p.rose_radius = vary(1.35, 1.55);
  p.rose_z = 6.25 + p.rose_radius + vary(0.15, 0.35);
  p.lancet_x = vary(4.15, 4.3);
  p.window_half = vary(0.6, 0.7);
  p.window_sill = vary(1.9, 2.2);
  p.window_springing = vary(3.9, 4.1);
  p.pew_rows = static_cast<int>((p.length - 6.6) / 1.0);
  return p;
}

double Plan::crown() const {
  return vaulted ? vault_springing + nave_half() : vault_springing + 1.1 * nave_half();
}

Outline Plan::cross_section() const {
  const double n = nave_half();
  Outline ring;
  ring.line_to({-half_width, floor});
  ring.line_to({half_width, floor});
  ring.line_to({half_width, aisle_ceiling});
  ring.line_to({n, aisle_ceiling});
  if (vaulted) {
    ring.arc({0, vault_springing}, n, 0, std::numbers::pi, 1);
  } else {
    ring.line_to({n, vault_springing});
    ring.line_to({0, crown()});
  }
  ring.line_to({-n, vault_springing});
  ring.line_to({-n, aisle_ceiling});
  ring.line_to({-half_width, aisle_ceiling});
  return ring;
}

Outline Plan::portal_outline(double half) const {
  return arched(0, half, 0.2, portal_springing, 0.85);
}

Outline Plan::window_outline(double middle, double grown_by) const {
  return grown(arched(middle, window_half, window_sill, window_springing, arch_sharpness), grown_by);
}

}  // namespace synth
