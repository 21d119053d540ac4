#include "core/interrupt.hpp"

#include <csignal>

#include "core/error.hpp"

namespace hybrid {
namespace {

volatile std::sig_atomic_t interrupted = 0;

const char* name_of(int number) {
  switch (number) {
    case SIGINT:
      return "SIGINT";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "SIGTERM";
  }
}

extern "C" void on_signal(int number) {
  interrupted = number;
  std::signal(number, SIG_DFL);  // a second one ends the process at once
}

}  // namespace

void install_interrupt_handlers() {
  std::signal(SIGTERM, on_signal);
  // Background jobs of a shell and nohup are started with these ignored: that stays so.
  for (int number : {SIGINT, SIGHUP})
    if (std::signal(number, on_signal) == SIG_IGN) std::signal(number, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void check_interrupted() {
  if (interrupted)
    fail(ErrorKind::interrupted, "interrupted by {}; complete files stay, run again to go on",
         name_of(interrupted));
}

}  // namespace hybrid
