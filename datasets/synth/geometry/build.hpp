#pragma once
#include "geometry/mesh.hpp"

namespace synth {

std::uint32_t add_vertex(Mesh&, const Vec3&);
std::uint32_t add_vertex(Mesh&, const Vec3&, const Vec3& normal, const Eigen::Vector2d& coordinates);
void add_triangle(Mesh&, std::uint32_t surface, std::uint32_t a, std::uint32_t b, std::uint32_t c);

// A planar surface with the next free plane id, no triangles yet; normal = u_axis x v_axis.
std::uint32_t add_plane(Mesh&, const std::string& name, Material, const Vec3& origin, const Vec3& u_axis,
                        const Vec3& v_axis);

std::uint32_t add_free_surface(Mesh&, const std::string& name, Material);

// A plane with the next free id whose light and texture come from its vertices, as a free surface's do: a
// flat face of something bent.
std::uint32_t add_flat_free_surface(Mesh&, const std::string& name, Material, const Vec3& point,
                                    const Vec3& normal);

}  // namespace synth
