#pragma once
#include <filesystem>
#include <vector>

#include "trace/scanner.hpp"

namespace synth {

void write_truth_json(const std::filesystem::path&, const Room&, const Tracer&, const RoomOptions&,
                      const std::vector<Scan>&, const std::vector<Camera>& photographs,
                      const std::vector<Camera>& held_out_views);

}  // namespace synth
