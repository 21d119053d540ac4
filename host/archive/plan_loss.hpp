#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/store.hpp"

namespace hybrid::archive {

// What an archive that is not all there, such as a share that is not mounted, does to a plan.

// Throws ErrorKind::input when the plan has no units, naming the folder and what was looked for: a plan of
// nothing would look like one whose work is done.
void expect_units(const Manifest& manifest);

// Units, by id, of the latest plan of a store that had any: scenes and scans.
struct PlanLoss {
  std::size_t before = 0;
  std::vector<std::string> gone;  // that the new plan lacks, in the order of the older one

  bool is_most() const { return 2 * gone.size() > before; }
};
PlanLoss loss_since_last_night(const Store& store, const Manifest& manifest);
// What is said when most is gone.
std::string describe(const PlanLoss& loss, const Manifest& manifest);

}  // namespace hybrid::archive
