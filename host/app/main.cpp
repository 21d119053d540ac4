#include <CLI/CLI.hpp>
#include <iostream>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/log.hpp"

// The command table: one line per command, one short file per command beside this one.
int main(int argc, char** argv) {
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
  app::add_info(program, code);
  app::add_devices(program, code);

  install_interrupt_handlers();
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : exit_code(ErrorKind::usage);
  } catch (const Error& error) {
    log::error("{}", error.what());
    return exit_code(error.kind());
  } catch (const std::bad_alloc&) {
    log::error("{}", kOutOfMemory);
    return exit_code(ErrorKind::device);
  } catch (const std::exception& error) {
    log::error("internal error: {}", error.what());
    return 1;
  }
  std::cout.flush();
  if (!std::cout) {
    log::error("stdout: not everything could be written; the disk is full or the reading end is closed");
    return exit_code(ErrorKind::failed);
  }
  return code;
}
