#include <cmath>

#include "church/church.hpp"

namespace synth {

World build_church(const Options& options) {
  const Plan plan = draw_plan(options.seed);
  Random random(options.seed, purpose::layout, 1);
  World world;
  world.kind = "church";
  world.size = {2 * plan.outer_half(), plan.outer_length(), plan.ridge};
  add_front(world, plan);
  add_walls_and_roof(world, plan);
  add_nave(world, plan);
  furnish(world, plan, random);
  add_churchyard(world, random);
  hang_church_decor(world, plan);
  add_church_proxy(world, plan);
  move_faces(world.proxy, options);
  place_church_viewpoints(world, plan, options);

  // Afternoon, from the south-west: across the front, so that recesses and mouldings throw shadows.
  const double azimuth = random.uniform(-2.35, -2.1), height = random.uniform(0.62, 0.75);
  world.sun =
      Sun{{std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth), std::sin(height)},
          Eigen::Array3d(1.02, 0.93, 0.78)};
  const double low = plan.wall;
  world.interior = Box{{-plan.half_width - 0.5, low - 0.4, plan.floor - 0.1},
                       {plan.half_width + 0.5, low + plan.length + 0.45, plan.crown() + 0.3}};
  return world;
}

}  // namespace synth
