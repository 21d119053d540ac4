#pragma once
#include <filesystem>

#include "trace/scanner.hpp"

namespace synth {

void write_scan_ply(const std::filesystem::path&,
                    const Scan&);  // x y z intensity, scan frame, acquisition order
void write_detail_ply(const std::filesystem::path&, const Mesh&);  // faces carry `surface` and `plane`
void write_proxy_obj(const std::filesystem::path&, const std::vector<Vec3>& vertices);

}  // namespace synth
