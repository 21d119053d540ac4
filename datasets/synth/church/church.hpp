// The church: a nave with aisles along y, its front in the plane y = 0 looking along -y, x across, z up;
// x = 0 is the middle, z = 0 the churchyard. Everything hangs on the plan, which the seed draws.
#pragma once
#include "geometry/random.hpp"
#include "geometry/solids.hpp"
#include "world/world.hpp"

namespace synth {

struct Plan {
  double half_width;                                      // inner, to the aisle walls
  double length;                                          // inner, between the end walls
  double wall;                                            // thickness of all walls
  double aisle_ceiling;                                   // z
  double arcade;                                          // x of the arcades' middle
  double arcade_thick;                                    // of the walls above the columns
  int bays;                                               // arches of an arcade
  double springing;                                       // z of the columns' tops
  double arch_sharpness;                                  // 0.5 round .. 1 pointed
  double vault_springing;                                 // z where the nave's ceiling starts
  bool vaulted;                                           // barrel vault; else a timber ceiling of two slopes
  double eaves, ridge;                                    // z of the roof
  double upper_step = 0.27;                               // z of its top, before the portal and in its foot
  double portal_half, portal_springing, portal_depth[2];  // depth: of the outer and the inner order
  double rose_z, rose_radius;
  double lancet_x;
  double window_half, window_sill, window_springing;
  int pew_rows;
  double floor = 0.30;

  double outer_half() const { return half_width + wall; }
  double outer_length() const { return length + 2 * wall; }
  double inner_y(double y) const { return wall + y; }  // y from the entrance's inner face
  double bay() const { return length / bays; }
  double nave_half() const { return arcade - arcade_thick / 2; }
  double crown() const;  // z of the nave's ceiling in the middle
  double slope() const { return (ridge - eaves) / outer_half(); }
  // The inside's cross-section: outline of an end wall as seen from inside or, mirrored, from outside.
  Outline cross_section() const;
  Outline portal_outline(double half) const;
  Outline window_outline(double middle, double grown_by) const;
};
Plan draw_plan(std::uint64_t seed);

World build_church(const Options&);

// Its parts, in the order in which they are built.
void add_front(World&, const Plan&);           // with portal, rose window, lancets, mouldings
void add_walls_and_roof(World&, const Plan&);  // side walls, end wall, roof, buttresses, floor, churchyard
void add_nave(World&, const Plan&);            // columns, arcades, ceilings
void furnish(World&, const Plan&, Random&);    // pews, altar, pulpit, visitors
void add_churchyard(World&, Random&);
void hang_church_decor(World&, const Plan&);
void add_church_proxy(World&, const Plan&);
void place_church_viewpoints(World&, const Plan&, const Options&);

void add_person(World&, const std::string& name, const Vec3& foot, double height_m, double turn_rad);

}  // namespace synth
