#include "app/scene_command.hpp"

namespace hybrid::app {

void add_register(CLI::App& program, int& exit_code) {
  const auto scene =
      make_scene_command(program, "register", "poses: scans/<id>/pose.json; registered scans on request");
  const auto write = std::make_shared<std::string>();
  scene.command->add_option(
      "--write", *write,
      "also write every registered scan, scans/<id>/registered.<format>: some of e57, las, pcd, ply, pts, "
      "ptx; the same as --set register.write=...");
  scene.command->callback([=, &exit_code] {
    if (!write->empty()) scene.common->assignments.push_back("register.write=" + *write);
    scene.request->stages = {"register"};
    exit_code = run_scene_command(scene);
  });
}

}  // namespace hybrid::app
