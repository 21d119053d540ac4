#include "archive/build_identity.hpp"

#include <source_hash.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "archive/store.hpp"
#include "core/error.hpp"
#include "device/device_list.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;

// Kernels read from disk instead of those in the program.
std::string kernel_folder_hash() {
  const char* const folder = std::getenv("HYBRID_KERNEL_DIR");
  if (!folder) return "";
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::recursive_directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code))
    if (entry->is_regular_file()) files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  std::string text;
  for (const auto& file : files)
    text += file.lexically_relative(folder).generic_string() + " " + io::fingerprint(file).xxh3 + "\n";
  return fmt::format("+{}", hash_of(text));
}

}  // namespace

BuildIdentity build_identity(const std::string& choice) {
  const auto device = device::choose_device(choice);
  const std::string kernels = kernel_folder_hash();
  // PoCL names a CPU "pthread-<instruction set>-<vendor> <model>": machines of one set give the same bits.
  const std::string set = device.is_cpu ? device.name.substr(0, device.name.find(' ')) : device.name;
  return {HYBRID_ALL_SOURCES + kernels, HYBRID_PLANES_SOURCES + kernels, HYBRID_BUILD_KIND,
          fmt::format("{}, {} {}", set, device.platform, device.driver_version)};
}

nlohmann::ordered_json to_json(const BuildIdentity& identity) {
  const auto& [all_sources, planes_sources, kind, device] = identity;
  return {{"all_sources", all_sources},
          {"planes_sources", planes_sources},
          {"kind", kind},
          {"device", device},
          {"version", HYBRID_VERSION}};
}

BuildIdentity identity_from_json(const nlohmann::ordered_json& json) {
  return {json.at("all_sources"), json.at("planes_sources"), json.at("kind"), json.at("device")};
}

}  // namespace hybrid::archive
