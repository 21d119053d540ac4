#include "cases/blend_photos_case.hpp"

#include "cases/render_view_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool blend_photos_points_added =
    add<testing::BlendPhotosCase>("1M scattered points, 3 photographs", 1'000'000);
const bool blend_photos_room_added = add<testing::BlendViewCase>("1080p, 204 triangles, 8 of 12 MP", 0);
const bool blend_photos_splats_added =
    add<testing::BlendViewCase>("1080p, 204 triangles and 500k splats, 8 of 12 MP", 500'000);
const bool blend_photos_bands_added =
    add<testing::MultiBandViewCase>("1080p, 204 triangles, 8 of 12 MP, 4 bands", 0);
}  // namespace hybrid::bench
