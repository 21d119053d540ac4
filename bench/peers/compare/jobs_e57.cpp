#include <stdexcept>

#include "compare/setup.hpp"

namespace hybrid::compare {

// The rate is that of the samples the program says it has read.
Job e57_job(const Setup& setup) {
  Job job{"reading E57", {{setup.e57.empty() ? "a scan" : setup.e57.filename().string(), 0}}, {}};
  Program ours;
  ours.name = "hybrid";
  ours.ours = true;
  ours.missing = "hybrid has no E57 reader of its own yet";
  Program peer;
  peer.name = "libE57Format";
  peer.missing = missing_external(setup, "libe57_read");
  if (peer.missing.empty() && setup.e57.empty()) peer.missing = "no scan: give one with --e57 FILE";
  peer.run = [=](const Case&) {
    return run_peer({(setup.external / "libe57_read").string(), "--input", setup.e57.string(), "--threads",
                     std::to_string(setup.threads)},
                    setup.run_limit_s);
  };
  job.programs = {ours, peer};
  return job;
}

}  // namespace hybrid::compare
