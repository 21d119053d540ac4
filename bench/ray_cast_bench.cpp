#include "cases/ray_cast_case.hpp"

#include "cases/render_view_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool ray_cast_rays_added = add<testing::RayCastCase>("1M rays in all directions", 1'000'000);
const bool ray_cast_room_added = add<testing::RayCastViewCase>("1080p, 204 triangles", 0);
const bool ray_cast_meshes_added =
    add<testing::RayCastViewCase>("1080p, 95k triangles", testing::RayCastViewCase::kMeshes);
const bool ray_cast_splats_added =
    add<testing::RayCastViewCase>("1080p, 204 triangles and 500k splats", 500'000);
}  // namespace hybrid::bench
