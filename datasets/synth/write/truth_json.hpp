#pragma once
#include <filesystem>
#include <vector>

#include "trace/scanner.hpp"

namespace synth {

void write_truth_json(const std::filesystem::path&, const World&, const Tracer&, const Options&,
                      const std::vector<ScanCounts>&, const std::vector<Camera>& held_out_views);

}  // namespace synth
