// Marching-squares codes of a label image (METHOD 4; Lorensen and Cline's table comes down to the 4-bit
// codes below), for all labels at once.
// Mapping: one work-item per cell. A cell lies between four nodes; its corners run clockwise as the image is
// seen: 0 = upper left, 1 = upper right, 2 = lower right, 3 = lower left.
// in:  labels[(rows + 1) * (cols + 1)]: the nodes, 0 = no label. The caller puts the seam's and the border's
//      nodes into the halo.
// out: codes[rows * cols]: nibble k = set of corners that have the same label as corner k, 0 when corner k
//      has none. 0xffff = inside one label, 0 = no label here: no contour passes.
// Params: ContourCellParams. Cost: 4 bytes read (the corners overlap), 2 written, about 20 operations.
// Reference twin: tests/reference/contour_cells.cpp.
#include "shared/params_contour_cells.h"

kernel void contour_cells(ContourCellParams params, global const uint* restrict labels,
                          global ushort* restrict codes) {
  const uint col = get_global_id(0), row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  const uint upper = row * (params.cols + 1u) + col, lower = upper + params.cols + 1u;
  const uint a = labels[upper], b = labels[upper + 1u], c = labels[lower + 1u], d = labels[lower];
  const uint ab = a == b, bc = b == c, cd = c == d, da = d == a, ac = a == c, bd = b == d;
  const uint code_a = a == 0u ? 0u : 1u | ab << 1 | ac << 2 | da << 3;
  const uint code_b = b == 0u ? 0u : ab | 2u | bc << 2 | bd << 3;
  const uint code_c = c == 0u ? 0u : ac | bc << 1 | 4u | cd << 3;
  const uint code_d = d == 0u ? 0u : da | bd << 1 | cd << 2 | 8u;
  codes[row * params.cols + col] = (ushort)(code_a | code_b << 4 | code_c << 8 | code_d << 12);
}
