#pragma once

namespace hybrid {

// SIGINT and SIGTERM set a flag; check_interrupted() between steps turns it into ErrorKind::interrupted, so
// that files in the making are removed by their writers and everything complete stays.
void install_interrupt_handlers();
void check_interrupted();

}  // namespace hybrid
