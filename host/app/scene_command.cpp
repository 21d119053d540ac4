#include "app/scene_command.hpp"

#include <iostream>

#include "batch/try_inputs.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/shell_words.hpp"
#include "report/report.hpp"

namespace hybrid::app {

SceneCommand make_scene_command(CLI::App& program, const std::string& name, const std::string& help) {
  SceneCommand made;
  made.command = program.add_subcommand(name, help);
  made.command
      ->add_option("scene", made.request->scene_file,
                   "the scene file (TOML), or a folder of scans or a scan file, which are registered to each "
                   "other")
      ->required();
  made.command->add_option("--out", made.request->out, "output folder")->required();
  add_salvage_option(*made.command, made.request->salvage);
  add_common_options(*made.command, *made.common);
  add_memory_option(*made.command, *made.common);
  add_set_option(*made.command, *made.common);
  return made;
}

int run_scene_command(const SceneCommand& command) {
  const auto& common = *command.common;
  auto& request = *command.request;
  apply(common);
  request.assignments = common.assignments;
  request.tile = common.tile;
  request.seed = common.seed;
  request.force = common.force;
  request.quiet = !shows_progress(common);
  request.command = own_command();
  if (common.dry_run) {
    const auto tried = batch::try_scene(request);
    print_dry_run(common, tried);
    return tried.exit_code;
  }
  const auto budget = memory_budget(common, request.out);
  device::Queue queue(common.device);
  const auto run = batch::run_scene(
      queue, request, [&](const batch::SceneRun& made) { report::write_report(queue, made, request.out); });
  if (common.json)
    std::cout << json_text(run.summary) << "\n";
  else
    std::cout << report::text_summary(run, request.out);
  return batch::exit_code(run);
}

}  // namespace hybrid::app
