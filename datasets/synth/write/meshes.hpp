#pragma once
#include <filesystem>

#include "geometry/mesh.hpp"
#include "world/proxy.hpp"

namespace synth {

void write_detail_ply(const std::filesystem::path&, const Mesh&);  // faces carry `surface` and `plane`
void write_proxy_obj(const std::filesystem::path&, const Proxy&);

}  // namespace synth
