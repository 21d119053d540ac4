#include "mounts.hpp"

#include <unistd.h>

#include "io/output.hpp"

namespace hybrid::e2e {

Outcome run_with_mounts(const std::string& lines) {
  const Scratch scratch;
  io::write_text(scratch / "lines.sh", lines);
  const char* option = geteuid() == 0 ? "-m" : "-rm";
  return run(std::string("unshare ") + option + " sh " + (scratch / "lines.sh").string());
}

bool may_mount() {
  static const bool may = [] {
    const Scratch scratch;
    return run_with_mounts("mount -t tmpfs none " + scratch.path().string()).exit_code == 0;
  }();
  return may;
}

}  // namespace hybrid::e2e
