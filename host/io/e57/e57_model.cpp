#include "io/e57/e57_model.hpp"

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
