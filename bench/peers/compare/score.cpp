#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "compare/process.hpp"
#include "compare/setup.hpp"

namespace hybrid::compare {

using Json = nlohmann::json;

Json read_json(const std::filesystem::path& file) {
  std::ifstream input(file);
  if (!input) throw std::runtime_error(file.string() + ": cannot be opened");
  return Json::parse(input);
}

void score_labels(const Setup& setup, const std::filesystem::path& scene, const std::string& id,
                  const std::filesystem::path& result, Row& row) {
  const auto scorer = setup.bin / "hybrid-score";
  if (!std::filesystem::exists(scorer)) {
    row.quality = "not scored: hybrid-score not built";
    return;
  }
  const Finished finished = run_process({scorer.string(), (scene / "truth.json").string(), result.string(),
                                         "--scan", id, "--no-decimation", "--json"},
                                        2 * setup.run_limit_s);
  if (const auto failure = failure_of(finished); !failure.empty()) {
    row.quality = "not scored: " + failure;
    return;
  }
  const Json score = Json::parse(finished.output);
  for (const Json& scan : score.at("scans")) {
    if (scan.at("id") != id || !scan.contains("planes")) continue;
    const Json& planes = scan.at("planes");
    row.score = planes;
    row.quality = fmt::format("{:.1f} % right, {} of {} planes, curved called planar {:.1f} %",
                              100 * planes.at("planar_samples_right_share").get<double>(),
                              planes.at("planes_found").get<int>(), planes.at("planes").get<int>(),
                              100 * planes.at("curved_called_planar_share").get<double>());
  }
}

}  // namespace hybrid::compare
