#pragma once
#include <memory>

#include "app/commands.hpp"
#include "batch/scene_run.hpp"

namespace hybrid::app {

// What `run`, `register` and `render` share: they are one pipeline over a scene file that writes different
// outputs.
struct SceneCommand {
  CLI::App* command = nullptr;
  std::shared_ptr<CommonOptions> common = std::make_shared<CommonOptions>();
  std::shared_ptr<batch::RunRequest> request = std::make_shared<batch::RunRequest>();
};

SceneCommand make_scene_command(CLI::App& program, const std::string& name, const std::string& help);

// Runs the scene with the stages in the request; prints to stdout; returns the exit code.
int run_scene_command(const SceneCommand& command);

}  // namespace hybrid::app
