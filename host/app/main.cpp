#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/log.hpp"
#include "core/memory_budget.hpp"
#include "core/suggest.hpp"
#include "device/device_list.hpp"

namespace {

using hybrid::ErrorKind;

bool returned = false;  // main() is about to

// PoCL's compiler ends the process by exit(1) when it cannot write its files: the only chance to say what
// that means and to give it an exit code of ours. The logger may be gone by now.
void explain_exit() {
  if (returned) return;
  const auto folder = hybrid::device::kernel_cache_folder();
  std::error_code code;
  const bool full = std::filesystem::space(folder, code).available < (1 << 20) && !code;
  std::fprintf(
      stderr,
      "error the OpenCL driver ended the program (its own words are above); its folder of compiled "
      "kernels is %s%s\n",
      folder.c_str(),
      full ? ", whose disk is full: free space and run again, or set POCL_CACHE_DIR to another" : "");
  std::_Exit(hybrid::exit_code(full ? ErrorKind::temporary : ErrorKind::device));
}

// CLI11 would only say that a command is missing.
void check_command(CLI::App& program, const std::string& name) {
  std::vector<std::string_view> known;
  for (const auto* command : program.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), name) == known.end())
    hybrid::fail(ErrorKind::usage, "{}; --help explains them", hybrid::unknown_name("command", name, known));
}

// The command table: one line per command, one short file per command beside this one.
int run_command(int argc, char** argv) {
  using namespace hybrid;
  CLI::App program{
      "Turns laser scans and photographs of architecture into registered, decimated, photo-textured models.\n"
      "Results go to stdout, everything else to stderr. Exit codes: 0 ok, 1 failed, 2 usage, 3 some units "
      "failed,\n"
      "4 bad input, 5 no device or out of memory, 75 temporary (the disk is full), 130 interrupted.",
      "hybrid"};
  program.set_version_flag("--version", std::string("hybrid ") + HYBRID_VERSION);
  program.require_subcommand(1);
  int code = 0;
  app::add_run(program, code);
  app::add_planes(program, code);
  app::add_register(program, code);
  app::add_render(program, code);
  app::add_convert(program, code);
  app::add_info(program, code);
  app::add_devices(program, code);
  app::add_options(program, code);
  app::add_batch(program, code);
  try {
    if (argc > 1 && argv[1][0] != '-') check_command(program, argv[1]);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : exit_code(ErrorKind::usage);
  }
  return code;
}

int run_and_report(int argc, char** argv) {
  using namespace hybrid;
  try {
    return run_command(argc, argv);
  } catch (const Error& error) {
    log::error("{}", error.what());
    return exit_code(error.kind());
  } catch (const std::bad_alloc&) {
    log::error("{}", kOutOfMemory);
    return exit_code(ErrorKind::device);
  } catch (const std::exception& error) {
    log::error("internal error: {}", error.what());
    return exit_code(ErrorKind::failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  hybrid::keep_freed_memory(true);
  hybrid::install_interrupt_handlers();
  std::atexit(explain_exit);
  int code = run_and_report(argc, argv);
  std::cout.flush();
  if (!std::cout && code == 0) {
    hybrid::log::error("stdout: could not be written whole; the disk is full or the reader has gone");
    code = hybrid::exit_code(ErrorKind::failed);
  }
  returned = true;
  return code;
}
