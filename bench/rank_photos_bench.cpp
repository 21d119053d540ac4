#include "cases/rank_photos_case.hpp"

#include "cases/render_view_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool rank_photos_points_added =
    add<testing::RankPhotosCase>("1M scattered points, 6 photographs", 1'000'000);
const bool rank_photos_room_added = add<testing::RankViewCase>("1080p, 204 triangles, 8 of 12 MP", 0);
}  // namespace hybrid::bench
