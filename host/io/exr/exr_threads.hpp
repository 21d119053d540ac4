#pragma once

namespace hybrid::io {

// Gives OpenEXR's shared pool as many threads as hybrid::thread_count(), for compressing tiles (none for one:
// the caller's own), and returns that number. Files have the same bytes for any number.
int start_exr_threads();

}  // namespace hybrid::io
