#pragma once
#include <cstdint>

#include "io/scan_stream.hpp"

namespace hybrid::io {

// How a LAS file gives coordinates: whole numbers of 32 bits, times a step, from an offset.
// ScanStream::las_steps() chooses them: the file's own where it has whole numbers of which 32 bits hold all
// (their offset shifted by whole steps if it must be). Else, about the middle of the extent, 0.01 mm if every
// coordinate survives in them, the next finer power of ten in which it does, or the finest that 32 bits
// allow, 1 nm at most; beyond 20 km of extent larger ones. A coordinate survives when it reads back as the
// same float or, where the scan has them, double but for the last digit.
struct LasSteps {
  Vec3 scale = Vec3::Constant(1e-5), offset = Vec3::Zero();
  Vec3 minimum = Vec3::Zero(), maximum = Vec3::Zero();  // as the file gives them
  double rounding_m = 0;  // by which a coordinate changes, at most; 0: none does

  std::int32_t whole(double value, int axis) const;
  double back(double value, int axis) const { return whole(value, axis) * scale[axis] + offset[axis]; }
};

}  // namespace hybrid::io
