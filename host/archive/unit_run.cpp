#include "archive/unit_run.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <optional>

#include "archive/store_lock.hpp"
#include "core/error.hpp"
#include "core/fail_point.hpp"
#include "core/json_text.hpp"
#include "core/memory_budget.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

using Json = nlohmann::ordered_json;

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// The kernel's high-water mark of this process' memory starts anew, where it can be told to.
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

std::uint64_t peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  return 0;
}

// A queue's profile counts from its beginning: of this unit is what has come since `before`.
void leave_other_units_out(const std::filesystem::path& timing, const device::Profile& before) {
  std::error_code code;
  if (!std::filesystem::exists(timing, code)) return;
  Json document = Json::parse(io::read_text(timing), nullptr, false);
  if (!document.is_object() || !document.contains("kernels")) return;
  Json kernels = Json::object();
  for (const auto& [label, row] : document["kernels"].items()) {
    const auto earlier = before.find(label);
    const device::ProfileRow none{};
    const device::ProfileRow& old = earlier == before.end() ? none : earlier->second;
    const auto launches = row["launches"].get<decltype(old.launches)>() - old.launches;
    if (launches > 0)
      kernels[label] = {{"launches", launches}, {"seconds", row["seconds"].get<double>() - old.seconds}};
  }
  document["kernels"] = kernels;
  io::write_text(timing, json_text(document) + "\n");
}

UnitResult run_kind(device::Queue& queue, const Store& store, const Manifest& manifest, const Unit& unit,
                    Outcomes& outcomes, const std::filesystem::path& work) {
  switch (unit.kind) {
    case UnitKind::planes:
      return run_planes_unit(queue, unit, work);
    case UnitKind::scene:
      return run_scene_unit(queue, store, manifest, unit, outcomes, work);
    default:
      return run_report_unit(store, manifest, unit, outcomes, work);
  }
}

}  // namespace

void run_unit(device::Queue& queue, const Store& store, const Manifest& manifest, const Unit& unit,
              Outcomes& outcomes, const std::string& key, const std::filesystem::path& work,
              std::uint64_t keep_bytes) {
  for (const Input& input : unit.inputs) check_unchanged(input);
  forget_peak();
  const std::uint64_t kept_before = resident_memory().bytes;
  const Timer timer;
  const double cpu_before = cpu_seconds();
  const device::Profile profile_before = queue.profile();
  std::optional<io::BroughtTogether> together(work);
  const UnitResult result = run_kind(queue, store, manifest, unit, outcomes, work);
  for (const Input& input : unit.inputs) check_unchanged(input);
  leave_other_units_out(work / "timing.json", profile_before);
  const Json object = {{"key", key},
                       {"kind", name_of(unit.kind)},
                       {"status", result.failures.empty() ? "done" : "partial"},
                       {"failures", result.failures},
                       {"from", Json::parse(unit.from)}};
  const Json record = {{"key", key},
                       {"unit", unit.id},
                       {"host", host_name()},
                       {"finished", utc_now()},
                       {"seconds", timer.seconds()},
                       {"cpu_s", cpu_seconds() - cpu_before},
                       {"memory_bytes", peak_bytes()},
                       {"kept_bytes", kept_before},
                       {"estimate", {{"cpu_s", unit.estimate_s}, {"memory_bytes", unit.estimate_bytes}}},
                       {"threads", thread_count()}};
  together.reset();
  store.commit_object(work, key, object, record);
  // Pages that go to the system and come back with the next unit are cleared each time.
  if (resident_memory().bytes > keep_bytes) malloc_trim(0);
}

}  // namespace hybrid::archive
