#pragma once
#include "write/scan_stream.hpp"

namespace synth {

// A tiled range image: channels x y z (as measured), range, intensity, mask (1 measured, 0 empty with NaN);
// first angles and steps of the grid in the header. The true direction of a sample is that of its x y z.
std::unique_ptr<ScanFile> open_range_exr(const std::filesystem::path&, const ScannerPose&, const Preset&);

// The truth of its pixels.
std::unique_ptr<ScanFile> open_truth_of_range_exr(const std::filesystem::path&, const ScannerPose&,
                                                  const Preset&);

}  // namespace synth
