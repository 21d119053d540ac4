#include "archive/plan_loss.hpp"

#include <algorithm>
#include <set>

#include "archive/night.hpp"
#include "core/error.hpp"
#include "core/log.hpp"
#include "io/read_scan.hpp"

namespace hybrid::archive {
namespace {

constexpr std::size_t kNamed = 3;  // for people: so many of a list

std::string first_of(const std::vector<std::string>& list) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, list.size()); ++i) text += (i == 0 ? "" : ", ") + list[i];
  return text + (list.size() > kNamed ? ", ..." : "");
}

std::string first_of(const std::vector<Remark>& problems, const std::vector<Remark>& notes) {
  std::vector<std::string> said;
  for (const auto* list : {&problems, &notes})
    for (const auto& [path, what] : *list) said.push_back(fmt::format("{} ({})", path, what));
  return said.empty() ? "" : "; left out: " + first_of(said);
}

// A damaged plan, or one of another version, is no measure.
std::size_t count_or_none(const std::filesystem::path& plan) {
  try {
    return count_units(plan);
  } catch (const Error& error) {
    log::warning("{}", error.what());
    return 0;
  }
}

}  // namespace

void expect_units(const Manifest& manifest) {
  if (!manifest.units.empty()) return;
  fail_input(
      "{}: expected scenes (scene.toml, *.scene.toml) or scans ({}) in it or below, found none; check the "
      "path, and whether the disk or share is mounted{}",
      manifest.archive.string(), io::scan_extensions(), first_of(manifest.problems, manifest.notes));
}

PlanLoss loss_since_last_night(const Store& store, const Manifest& manifest) {
  PlanLoss loss;
  std::set<std::string> ids;
  for (const Unit& unit : manifest.units) ids.insert(unit.id);
  for (const NightFile& night : nights_of(store)) {
    if (count_or_none(night.file) == 0) continue;
    for (const Unit& unit : read_manifest(night.file, Detail::schedule).units) {
      if (unit.kind == UnitKind::report) continue;
      ++loss.before;
      if (!ids.count(unit.id)) loss.gone.push_back(unit.id);
    }
    break;
  }
  return loss;
}

std::string describe(const PlanLoss& loss, const Manifest& manifest) {
  return fmt::format(
      "{}: {} of the {} scenes and scans of the store's last plan are gone ({}); where a disk or share is "
      "not "
      "mounted, mount it and plan again before hybrid batch prune forgets them",
      manifest.archive.string(), loss.gone.size(), loss.before, first_of(loss.gone));
}

}  // namespace hybrid::archive
