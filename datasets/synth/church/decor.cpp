#include "church/church.hpp"

namespace synth {

void hang_church_decor(World& world, const Plan& plan) {
  const double half = plan.outer_half();
  const auto on = [&](const std::string& name, const Decor& decor) { hang(world, name, decor); };
  world.decor_of_surface.resize(world.mesh.surfaces.size());
  // The tympanum's drawing starts at the front's lower left corner.
  const double sill = plan.portal_springing + 0.15;
  on("tympanum", {Picture::plaque, half - 0.75, sill + 0.1, 1.5, 0.75, "DOMUS DEI/PORTA CAELI/ANNO 1204"});
  on("front", {Picture::sign, half + 2.0 + 1.15, 5.05, 2.2, 0.36, "SAINT MARTIN"});
  on("front", {Picture::plaque, half - 5.3, 4.95, 2.1, 0.55, "BUILT BY MANY HANDS/RESTORED 1911"});
  on("notice-board-front", {Picture::notice, 0.06, 0.06, 0.60, 0.83, "SERVICES"});
  on("notice-board-front", {Picture::chart, 0.72, 0.30, 0.36, 0.56, "LENS"});
  on("notice-board-back", {Picture::star, 0.15, 0.06, 0.83, 0.83, ""});
  on("yard-wall-left-right", {Picture::star, 12.0, 0.1, 0.9, 0.9, ""});
  // Inner faces of the side walls, drawn from outside: between the windows.
  for (int bay = 1; bay < plan.bays; ++bay) {
    const double u = bay * plan.bay();
    const char* plaques[] = {"TO THE MEMORY OF/JOHN MASON/OF THIS PARISH/WHO BUILT TRUE/1741 TO 1806",
                             "NEAR THIS PLACE/LIES THE BODY OF/ANN WRIGHT/AGED 81 YEARS",
                             "ERECTED BY THE/BELL RINGERS/5040 CHANGES RUNG/26 MARCH 1893"};
    on("left-back", {Picture::plaque, u - 0.55, 2.2, 1.1, 1.3, plaques[bay % 3]});
    on("right-back", {bay % 2 ? Picture::landscape : Picture::blocks, u - 0.6, 2.1, 1.2, 1.4, ""});
  }
  on("end-wall", {Picture::numbers, half - plan.nave_half() + 0.55, 2.2, 0.7, 1.1, "HYMNS/214/38/507/92"});
  on("end-wall", {Picture::star, half + plan.nave_half() - 1.3, 2.2, 0.8, 0.8, ""});
  on("end-wall", {Picture::chart, half + plan.arcade + 0.75, 2.0, 1.1, 1.6, "AISLE"});
  on("end-wall", {Picture::notice, half - plan.arcade - 1.85, 2.0, 1.1, 1.6, "PSALMS"});
  on("tympanum-back", {Picture::notice, half + plan.arcade + 0.65, 1.3, 0.5, 0.45, "ROTA"});
  on("altar-front", {Picture::star, 0.65, 0.15, 0.7, 0.7, ""});
}

}  // namespace synth
