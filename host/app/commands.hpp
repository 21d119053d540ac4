#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "batch/dry_run.hpp"
#include "core/memory_budget.hpp"
#include "core/option_table.hpp"
#include "geometry/vectors.hpp"

namespace hybrid::app {

// Options every command has.
struct CommonOptions {
  std::string device;
  int threads = 0;
  std::optional<int> seed;
  bool json = false, quiet = false, dry_run = false, force = false;
  std::string log_level = "info";
  int tile = 1024;
  std::string memory;                    // --memory, as given
  std::vector<std::string> assignments;  // --set, as given
};

// Adds the common options to a command and keeps them alive with it.
void add_common_options(CLI::App& command, CommonOptions& options);
// Adds --set, for commands that have options of stages.
void add_set_option(CLI::App& command, CommonOptions& options);
// Adds --salvage, for commands that read scans.
void add_salvage_option(CLI::App& command, bool& salvage);
// Adds --memory, for commands that hold whole scans; `memory_budget` makes it good while it lives, nullptr
// without the option.
void add_memory_option(CLI::App& command, CommonOptions& options);
std::unique_ptr<MemoryBudget> memory_budget(const CommonOptions& options, const std::filesystem::path& out);
// Applies log level and thread count; call first in every command.
void apply(const CommonOptions& options);

// Progress is of level info.
bool shows_progress(const CommonOptions& options);

// "auto" or a number, as --square takes it.
OptionValue parse_square(const std::string& text);
// "X,Y,Z". Throws ErrorKind::usage naming the option.
Vec3 parse_place(const std::string& text, const std::string& option);
// What --dry-run says: problems on stderr, the rest, where there is something to do, as it is; or all as one
// JSON document.
void print_dry_run(const CommonOptions& options, const batch::DryRun& tried);

// "8G", "512M", "1.5GiB" in bytes of powers of 1024.
std::uint64_t parse_bytes(const std::string& text, const std::string& option);

// Each adds its subcommand to the program; the callback returns the exit code through `exit_code`.
void add_run(CLI::App& program, int& exit_code);
void add_planes(CLI::App& program, int& exit_code);
void add_register(CLI::App& program, int& exit_code);
void add_render(CLI::App& program, int& exit_code);
void add_convert(CLI::App& program, int& exit_code);
void add_info(CLI::App& program, int& exit_code);
void add_devices(CLI::App& program, int& exit_code);
void add_options(CLI::App& program, int& exit_code);
void add_batch(CLI::App& program, int& exit_code);

}  // namespace hybrid::app
