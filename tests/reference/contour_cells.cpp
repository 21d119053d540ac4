#include "cases/contour_cells_case.hpp"

namespace hybrid::testing {

ContourCellsCase::Output ContourCellsCase::reference(const Input& input) {
  Output codes;
  const std::size_t width = input.params.cols + 1u;
  for (std::size_t row = 0; row < input.params.rows; ++row)
    for (std::size_t col = 0; col < input.params.cols; ++col) {
      const std::size_t corner[4] = {row * width + col, row * width + col + 1, (row + 1) * width + col + 1,
                                     (row + 1) * width + col};
      unsigned code = 0;
      for (unsigned k = 0; k < 4; ++k)
        for (unsigned other = 0; other < 4; ++other)
          if (input.labels[corner[k]] != 0 && input.labels[corner[k]] == input.labels[corner[other]])
            code |= 1u << (4 * k + other);
      codes.push_back(static_cast<std::uint16_t>(code));
    }
  return codes;
}

}  // namespace hybrid::testing
