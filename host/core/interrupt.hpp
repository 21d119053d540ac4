#pragma once

namespace hybrid {

// SIGINT, SIGTERM and SIGHUP set a flag; check_interrupted() between steps turns it into
// ErrorKind::interrupted, so that files in the making are removed by their writers and everything complete
// stays. A second signal ends the process at once. A file over the size limit and a closed pipe become
// errors of the write instead of the end of the process.
void install_interrupt_handlers();
void check_interrupted();

}  // namespace hybrid
