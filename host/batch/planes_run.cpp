#include "batch/planes_run.hpp"

#include "batch/output_folder.hpp"
#include "batch/photographs/e57_images.hpp"
#include "batch/planes_json.hpp"
#include "batch/scene_scan.hpp"
#include "batch/timing_json.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

Json process_one(device::Queue& queue, const PlanesRequest& request, const std::string& id,
                 const std::filesystem::path& file, const io::FileFingerprint& print,
                 const io::ScanEntry& entry, Progress& progress) {
  io::SceneScan one;
  one.file = file;
  one.scanner = request.scanner;
  one.axes = request.axes;
  one.unit_m = request.unit_m;
  auto [product, remains] = make_planes(queue, id, one, entry, request.options, progress);
  progress.step("write", "scan " + id);
  const auto folder = request.out / "scans" / id;
  write_plane_outputs(folder, product, remains, {{"source", file.filename().string()}, {"hash", print.xxh3}});
  write_detail(folder, product, remains, nullptr);
  if (request.options.lossless) product.sample_file = write_samples(folder, product, remains);
  write_references(folder, file, entry.index, request.salvage);
  Json figures = scan_figures(product);
  figures["file"] = file.filename().string();
  figures["xxh3"] = print.xxh3;
  return figures;
}

}  // namespace

PlanesRun run_planes(device::Queue& queue, const PlanesRequest& request) {
  check_output_folder(request.out, "", {}, request.force);
  const OutputFolder folder(request.out, "", request.files);
  PlanesRun run;
  Progress progress(request.quiet);
  progress.expect(static_cast<int>(request.files.size()) * 7);
  Json scans = Json::array(), failures = Json::array();
  std::vector<std::string> ids;
  ErrorKind last_failure = ErrorKind::failed;
  const auto guarded = [&](const std::string& unit, const auto& body) {
    try {
      with_context(unit, body);
    } catch (const Error& error) {
      if (ends_the_run(error.kind())) throw;
      log::error("{}", error.what());
      failures.push_back({{"unit", unit}, {"error", error.what()}});
      last_failure = error.kind();
    }
  };
  for (const auto& file : request.files) {
    guarded("scan " + file.string(), [&] {
      progress.step("read", file.filename().string());
      const auto entries = io::list_scans(file, {.salvage = request.salvage});
      const auto print = io::fingerprint(file);
      progress.expect(7 * (static_cast<int>(entries.size()) - 1));
      for (std::size_t i = 0; i < entries.size(); ++i) {
        ids.push_back(io::default_scan_id(file, static_cast<int>(i), static_cast<int>(entries.size()), ids));
        const std::string id = ids.back();
        if (request.only && *request.only != i) continue;
        guarded("scan " + id, [&] {
          if (i > 0) progress.step("read", "scan " + id);
          scans.push_back(process_one(queue, request, id, file, print, entries[i], progress));
        });
      }
      if (request.only) io::scan_at(file, entries, *request.only);
    });
  }
  progress.finish();
  run.summary = {{"program", {{"name", "hybrid"}, {"version", HYBRID_VERSION}}},
                 {"options", describe(request.options)["planes"]},
                 {"scans", scans},
                 {"failures", failures}};
  const auto timing = timing_json(queue, progress, request.files, request.out);
  io::write_text(request.out / "timing.json", json_text(timing) + "\n");
  io::write_text(request.out / "summary.json", json_text(run.summary) + "\n");
  if (!failures.empty()) run.exit_code = scans.empty() ? hybrid::exit_code(last_failure) : 3;
  return run;
}

std::string text_of(const PlanesRun& run) {
  std::string text = fmt::format("{:<24} {:>10} {:>11} {:>13} {:>10}\n", "scan", "measured", "grid",
                                 "superclusters", "discarded");
  for (const auto& scan : run.summary["scans"])
    text += fmt::format(
        "{:<24} {:>10} {:>11} {:>13} {:>9.1f}%\n", scan["id"].get<std::string>(),
        scan["decimation"]["measured"].get<std::int64_t>(),
        fmt::format("{}x{}", scan["grid"]["rows"].get<int>(), scan["grid"]["cols"].get<int>()),
        scan["superclusters"].get<std::int64_t>(), 100 * scan["decimation"]["discarded_share"].get<double>());
  for (const auto& failure : run.summary["failures"])
    text += "failed: " + failure["error"].get<std::string>() + "\n";
  return text;
}

}  // namespace hybrid::batch
