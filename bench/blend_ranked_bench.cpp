#include "cases/blend_ranked_case.hpp"

#include "cases/render_view_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool blend_ranked_points_added =
    add<testing::BlendRankedCase>("1M scattered points, 6 photographs", 1'000'000);
const bool blend_ranked_room_added = add<testing::BlendRankedViewCase>("1080p, 204 triangles, 8 of 12 MP", 0);
}  // namespace hybrid::bench
