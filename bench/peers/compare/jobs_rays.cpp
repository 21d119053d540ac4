#include <stdexcept>

#include "compare/setup.hpp"

namespace hybrid::compare {

std::vector<Row> ray_rows(const Setup& setup) {
  const std::string missing = missing_peer(setup, "embree_rays", "Embree (or the kernels' test cases)");
  const auto not_run = [](const std::string& reason) {
    Row row;
    row.job = "rays, photographs, closest points";
    row.program = "Embree, nanoflann";
    row.outcome = Outcome::not_run;
    row.reason = reason;
    return std::vector<Row>{row};
  };
  if (!missing.empty()) return not_run(missing);
  if (setup.ladder.say) setup.ladder.say("rays, photographs and closest points");
  std::vector<std::string> command = {(setup.bin / "peers" / "embree_rays").string(), "--threads",
                                      std::to_string(setup.threads), "--rounds",
                                      std::to_string(setup.quick ? 1 : setup.ladder.rounds)};
  if (setup.quick) command.push_back("--quick");
  try {
    std::vector<Row> rows;
    const Run all = run_peer(command, 2 * setup.run_limit_s);
    for (const auto& entry : all.report.at("rows")) {
      Row row;
      row.job = entry.at("job");
      row.size = entry.at("size");
      row.program = entry.at("program");
      row.package = entry.at("package");
      row.settings = entry.at("settings");
      row.quality = entry.at("quality");
      row.ours = entry.at("ours");
      row.samples = entry.at("items");
      for (const auto& seconds : entry.at("seconds")) row.runs.push_back({seconds, 0, 0, 0, {}});
      rows.push_back(row);
    }
    return rows;
  } catch (const std::exception& problem) {
    return not_run(std::string("failed: ") + problem.what());
  }
}

}  // namespace hybrid::compare
