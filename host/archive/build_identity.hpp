#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace hybrid::archive {

// What results depend on beside inputs and options. Made at build time from the sources themselves.
struct BuildIdentity {
  std::string all_sources;     // hash over host/ and kernels/
  std::string planes_sources;  // the same without report, command line and engine: what a scan's planes need
  std::string kind;            // compiler, its version, build type
  std::string device;          // instruction set that the OpenCL driver compiles for, and its version
  bool operator==(const BuildIdentity&) const = default;
};

// Of this program with the device that `choice` (device::choose_device) means. With HYBRID_KERNEL_DIR the
// kernels there count. Throws ErrorKind::device when there is no such device.
BuildIdentity build_identity(const std::string& choice);

nlohmann::ordered_json to_json(const BuildIdentity& identity);
BuildIdentity identity_from_json(const nlohmann::ordered_json& json);

}  // namespace hybrid::archive
