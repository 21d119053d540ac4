#include "core/interrupt.hpp"

#include <csignal>

#include "core/error.hpp"

namespace hybrid {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void on_signal(int number) {
  interrupted = number;
  std::signal(number, SIG_DFL);  // a second one ends the process at once
}

}  // namespace

void install_interrupt_handlers() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

void check_interrupted() {
  if (interrupted)
    fail(ErrorKind::interrupted, "interrupted by signal {}; complete files stay, run again to go on",
         static_cast<int>(interrupted));
}

}  // namespace hybrid
