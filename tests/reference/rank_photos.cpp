#include "cases/rank_photos_case.hpp"

#include <algorithm>

#include "reference/photo_sight.hpp"

namespace hybrid::testing {

RankPhotosCase::Input RankPhotosCase::make(std::size_t size, std::uint32_t seed) {
  Input input{BlendPhotosCase::make(size, seed)};
  auto& photos = input.blend.photos;
  for (std::size_t i = 0, once = photos.size(); i < once; ++i) {
    auto copy = photos[i];
    copy.photograph.cam_from_world.translation += Vec3(0.3, -0.2, 0.5);
    std::reverse(copy.pixels.begin(), copy.pixels.end());  // colours and mask move
    photos.push_back(std::move(copy));
  }
  return input;
}

RankPhotosCase::Output RankPhotosCase::reference(const Input& input) {
  const std::size_t count = input.blend.count();
  Output out{std::vector<float>(input.kept * count, std::numeric_limits<float>::infinity()),
             std::vector<std::int32_t>(input.kept * count, -1), std::vector<std::uint32_t>(count, 0)};
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::pair<double, std::int32_t>> ranks;
    for (std::size_t j = 0; j < input.blend.photos.size(); ++j) {
      const auto sight = photo_sight(input.blend, j, i);
      if (!sight) continue;
      const double covers = sight->distance * input.pixel_ratio / std::max(sight->facing, 0.05);
      const double view_covers = sight->eye_distance / std::max(std::abs(sight->eye_facing), 0.05);
      ranks.emplace_back(sight->angle + input.resolution_cost * std::max(covers / view_covers - 1, 0.0) +
                             input.field_of_view_cost * (1 - sight->feather),
                         static_cast<std::int32_t>(j));
    }
    out.seen[i] = static_cast<std::uint32_t>(ranks.size());
    std::sort(ranks.begin(), ranks.end());
    for (std::size_t r = 0; r < std::min<std::size_t>(ranks.size(), input.kept); ++r) {
      out.penalty[r * count + i] = static_cast<float>(ranks[r].first);
      out.photo[r * count + i] = ranks[r].second;
    }
  }
  return out;
}

}  // namespace hybrid::testing
