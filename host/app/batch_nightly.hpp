#pragma once
#include <CLI/CLI.hpp>
#include <memory>

#include "archive/slurm.hpp"

namespace hybrid::app {

// hybrid batch gather, diff, bench: what is made of nights.
void add_gather(CLI::App& batch, int& exit_code);
void add_diff(CLI::App& batch, int& exit_code);
void add_bench(CLI::App& batch, int& exit_code);

// --engine of `hybrid batch run`.
struct EngineChoice {
  std::string engine = "local", slurm_arguments;
  archive::SlurmOptions slurm;
  bool slurm_asked() const { return engine == "slurm"; }
};
std::shared_ptr<EngineChoice> add_engine_options(CLI::App& command);
// Submits the store's plan and prints the jobs. Options of `command` that concern a task go with it.
void submit_batch(const CLI::App& command, const EngineChoice& choice, const archive::Store& store,
                  const std::string& units, bool retry, bool json);

}  // namespace hybrid::app
