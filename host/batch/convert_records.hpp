#pragma once
#include "batch/convert_run.hpp"

namespace hybrid::batch {

// Whether both sides keep records as stored: from E57 or range images with records to one of these.
bool converts_records(const ConvertRequest& request);

// The files that a conversion writes, and of an E57 file's several scans which goes where; a folder for
// photographs and tables last, where there are any. In salvage throws ErrorKind::input for a description that
// cannot be copied.
std::vector<std::filesystem::path> record_outputs(const ConvertRequest& request);

// How many photographs an E57 file holds, or its range image: the other formats hold none.
std::size_t photographs_in(const ConvertRequest& request);

// The conversion, scan by scan where it can. Throws and returns as run_convert().
ConvertRun convert_records(const ConvertRequest& request);

}  // namespace hybrid::batch
