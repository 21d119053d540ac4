#pragma once

namespace hybrid {

// A named place at which a test lets the process die as a power cut would: with HYBRID_FAIL_AT=<point>:<n> in
// the environment the n-th call (from 1) of this process with that name ends it by SIGKILL; with
// <point>:<n>:group its whole process group; with <point>:<n>:pause it stands still for half a second, as on
// a machine under load. Does nothing otherwise.
void fail_point(const char* point);

}  // namespace hybrid
