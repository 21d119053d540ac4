#include "geometry/range_image.hpp"

#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "core/large_vector.hpp"
#include "core/parallel.hpp"
#include "geometry/angles.hpp"
#include "geometry/placed_range_image.hpp"

namespace hybrid {

bool is_full_turn(const std::vector<double>& azimuth_rad) {
  constexpr double kOpenGap = 3;  // columns
  if (azimuth_rad.size() < 2) return false;
  const double turn = azimuth_rad.back() - azimuth_rad.front();
  return kTurn - std::abs(turn) <= kOpenGap * (turn / static_cast<double>(azimuth_rad.size() - 1));
}

RangeImage make_range_image(int rows, int cols, std::vector<std::uint32_t> source) {
  RangeImage image;
  image.rows = rows;
  image.cols = cols;
  image.source = std::move(source);
  image.elevation_rad.assign(static_cast<std::size_t>(rows), 0.0);
  image.azimuth_rad.assign(static_cast<std::size_t>(cols), 0.0);
  const std::size_t count = image.count();
  // Memory touched for the first time costs more than the values: a thread for each.
  const std::function<void()> fill[] = {[&] { assign_large(image.range_m, count, kNaN); },
                                        [&] { assign_large(image.x, count, kNaN); },
                                        [&] { assign_large(image.y, count, kNaN); },
                                        [&] { assign_large(image.z, count, kNaN); },
                                        [&] {
                                          if (image.source.empty())
                                            assign_large(image.source, count, kNoSource);
                                        },
                                        [&] { assign_large(image.mask, count, std::uint8_t{kEmpty}); }};
  parallel_for(std::size(fill), [&](std::size_t i) { fill[i](); });
  return image;
}

RangeImage make_range_image(int rows, int cols) {
  return make_range_image(rows, cols, {});
}

}  // namespace hybrid
