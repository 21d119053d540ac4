#include <filesystem>
#include <iostream>
#include <set>

#include "app/commands.hpp"
#include "batch/try_inputs.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/read_scan.hpp"

namespace hybrid::app {

void add_planes(CLI::App& program, int& exit_code) {
  auto* command =
      program.add_subcommand("planes", "plane extraction, contours and decimation of single scans");
  auto common = std::make_shared<CommonOptions>();
  auto request = std::make_shared<batch::PlanesRequest>();
  auto square = std::make_shared<std::string>("auto");
  command->add_option("scans", request->files, "scan files (" + io::scan_extensions() + ")")->required();
  command->add_option("--out", request->out, "output folder")->required();
  command->add_option("--square", *square, "side of the squares in samples: auto or 3..16");
  auto scanner = std::make_shared<std::string>();
  command->add_option(
      "--scanner", *scanner,
      "X,Y,Z: where the scanner stood, metres in the files' coordinates, for files that cannot say "
      "(PTS, LAS, PLY, ...); else it is taken to stand at their origin");
  auto axes = std::make_shared<std::string>("z-up");
  command
      ->add_option("--axes", *axes,
                   "how the files' axes lie: z-up, camera (x right, y down, z forward) or opengl (x right, "
                   "y up, z backward), for what depth cameras wrote")
      ->check(CLI::IsMember(io::kScanAxesNames));
  auto unit = std::make_shared<std::string>("m");
  std::vector<std::string> units;
  for (const io::ScanUnit& one : io::kScanUnits) units.emplace_back(one.name);
  command->add_option("--unit", *unit, "of the files' lengths; --scanner is in metres")
      ->check(CLI::IsMember(units));
  add_salvage_option(*command, request->salvage);
  add_common_options(*command, *common);
  add_memory_option(*command, *common);
  add_set_option(*command, *common);
  command->callback([=, &exit_code] {
    apply(*common);
    for (const auto& assignment : common->assignments) request->options.set(assignment);
    if (command->count("--square")) request->options.set_square(parse_square(*square));
    if (command->count("--scanner") > 0) request->scanner = parse_place(*scanner, "--scanner");
    request->unit_m = io::metres_of_unit(*unit);
    request->axes = io::scan_axes_of(*axes);
    request->options.set_tile(common->tile);
    if (common->seed) request->options.set_seed(*common->seed);
    request->quiet = !shows_progress(*common);
    request->force = common->force;
    if (common->dry_run) {
      const auto tried = batch::try_planes(*request);
      print_dry_run(*common, tried);
      exit_code = tried.exit_code;
      return;
    }
    const auto budget = memory_budget(*common, request->out);
    device::Queue queue(common->device);
    const auto run = batch::run_planes(queue, *request);
    if (common->json)
      std::cout << json_text(run.summary) << "\n";
    else
      std::cout << batch::text_of(run);
    exit_code = run.exit_code;
  });
}

}  // namespace hybrid::app
