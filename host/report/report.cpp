#include "report/report.hpp"

#include <algorithm>

#include "report/figures.hpp"
#include "report/scene_page.hpp"

namespace hybrid::report {

void write_report(device::Queue& queue, const batch::SceneRun& run, const std::filesystem::path& out) {
  if (std::any_of(run.registrations.begin(), run.registrations.end(),
                  [](const auto& registration) { return registration.has_value(); }))
    write_registration_figures(queue, run, out / "report");
  ScenePage page;
  page.out = out;
  page.summary = run.summary;
  for (const auto& failure : run.failures) page.failures.push_back({failure.unit, failure.error});
  write_scene_page(page);
}

}  // namespace hybrid::report
