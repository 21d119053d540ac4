#include "app/scene_command.hpp"

namespace hybrid::app {

void add_register(CLI::App& program, int& exit_code) {
  const auto scene = make_scene_command(program, "register", "poses only: scans/<id>/pose.json");
  scene.command->callback([=, &exit_code] {
    scene.request->stages = {"register"};
    exit_code = run_scene_command(scene);
  });
}

}  // namespace hybrid::app
