#include "batch/timing_json.hpp"

#include <unistd.h>

#include <array>

#include "core/json_text.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace

Json timing_json(device::Queue& queue, const Progress& progress,
                 const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out) {
  Json files = Json::array(), kernels = Json::object();
  for (const auto& file : inputs) files.push_back(std::filesystem::absolute(file).string());
  for (const auto& [label, row] : queue.profile())
    kernels[label] = {{"launches", row.launches}, {"seconds", row.seconds}};
  return {{"host", host_name()},
          {"device", queue.device().name},
          {"threads", thread_count()},
          {"inputs", files},
          {"out", std::filesystem::absolute(out).string()},
          {"seconds_by_stage", progress.seconds_by_stage()},
          {"kernels", kernels}};
}

void write_timing(const std::filesystem::path& out, const Json& timing, bool page) {
  io::write_text(out / "timing.json", json_text(timing) + "\n");
  if (page) io::write_text(out / "report" / "timing.js", "hybridTiming(" + json_text(timing) + ");\n");
}

}  // namespace hybrid::batch
