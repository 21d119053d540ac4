#include "app/scene_command.hpp"

namespace hybrid::app {

void add_render(CLI::App& program, int& exit_code) {
  const auto scene = make_scene_command(program, "render", "views only: views/<name>.exr and .png");
  scene.command->add_option("--view", scene.request->only_view, "this view alone");
  scene.command->add_flag(
      "--leave-one-out", scene.request->leave_one_out,
      "instead of the scene's views, every photograph's made from all the others, scored");
  scene.command
      ->add_option("--show", scene.request->show,
                   "what every view shows, instead of what the scene file says: proxy, scan or both")
      ->check(CLI::IsMember({"proxy", "scan", "both"}));
  scene.command->callback([=, &exit_code] {
    scene.request->stages = {"render"};
    scene.request->scene_views = !scene.request->leave_one_out;
    exit_code = run_scene_command(scene);
  });
}

}  // namespace hybrid::app
