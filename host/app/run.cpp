#include <fmt/ranges.h>

#include "app/scene_command.hpp"

namespace hybrid::app {
namespace {

std::set<std::string> parse_stages(const std::vector<std::string>& names) {
  if (names.empty()) return batch::kAllStages;
  for (const auto& name : names) {
    if (batch::kAllStages.count(name) == 0 && name != "export")
      fail(ErrorKind::usage, "--only {}: expected stages among {}, export", name,
           fmt::join(batch::kAllStages, ", "));
  }
  return {names.begin(), names.end()};
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
  const auto scene = make_scene_command(program, "run", "one scene, all its stages");
  auto only = std::make_shared<std::vector<std::string>>();
  scene.command
      ->add_option(
          "--only", *only,
          "stages whose outputs are written, among planes,register,edit,render,report,export; what they need "
          "is "
          "computed "
          "again from the inputs, never taken from DIR; report writes the others too, since its page shows "
          "them; without --only all but export, which runs where the scene file has [export] or --set a key "
          "of it")
      ->delimiter(',')
      ->allow_extra_args(false);  // what follows is the scene
  scene.command->add_flag("--leave-one-out", scene.request->leave_one_out,
                          "after the scene's views, every photograph's made from all the others, scored");
  scene.command->callback([=, &exit_code] {
    scene.request->stages = parse_stages(*only);
    scene.request->stages_by_scene = only->empty();
    exit_code = run_scene_command(scene);
  });
}

}  // namespace hybrid::app
