#include "io/e57/e57_model.hpp"

#include <algorithm>
#include <bit>

namespace hybrid::io {

int E57Field::bits() const {
  switch (type) {
    case E57Type::single_real:
      return 32;
    case E57Type::double_real:
      return 64;
    case E57Type::text:
      return 0;
    default:  // unsigned: the difference may exceed the signed range
      return std::bit_width(static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum));
  }
}

std::uint64_t word_padded_bytes(const E57Field& field, std::uint64_t count) {
  const auto width = static_cast<std::uint64_t>(field.bits());
  if (width == 0) return 0;
  const std::uint64_t word = std::max<std::uint64_t>(8, std::bit_ceil(width));
  return (count * width + word - 1) / word * word / 8;
}

const char* name_of(E57Projection projection) {
  switch (projection) {
    case E57Projection::pinhole:
      return "pinhole";
    case E57Projection::spherical:
      return "spherical";
    case E57Projection::cylindrical:
      return "cylindrical";
    default:
      return "visual reference";
  }
}

}  // namespace hybrid::io
