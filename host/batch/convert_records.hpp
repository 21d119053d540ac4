#pragma once
#include "batch/convert_run.hpp"

namespace hybrid::batch {

// Whether both sides keep records as stored: from E57 or range images with records to one of these.
bool converts_records(const ConvertRequest& request);

// The files that a conversion writes, and of an E57 file's several scans which goes where; a folder for
// photographs and tables last, where there are any.
std::vector<std::filesystem::path> record_outputs(const ConvertRequest& request);

// How many photographs an E57 file holds, or its range image: the other formats hold none.
std::size_t photographs_in(const ConvertRequest& request);

// The conversion, scan by scan where it can. Throws and returns as run_convert(); nothing when the input is
// damaged and salvage is asked for: samples, then, are what can be saved.
std::optional<ConvertRun> convert_records(const ConvertRequest& request);

}  // namespace hybrid::batch
