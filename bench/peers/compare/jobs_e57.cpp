#include <stdexcept>

#include "compare/setup.hpp"

namespace hybrid::compare {

// The rate is that of the samples the program says it has read.
Job e57_job(const Setup& setup) {
  Job job{"reading E57", {{setup.e57.empty() ? "a scan" : setup.e57.filename().string(), 0}}, {}};
  Program ours;
  ours.name = "hybrid";
  ours.ours = true;
  if (setup.e57.empty()) ours.missing = "no scan: give one with --e57 FILE";
  ours.run = [=](const Case&) {
    return run_peer({(setup.bin / "hybrid-read-bench").string(), setup.e57.string(), "--runs", "1",
                     "--threads", std::to_string(setup.threads), "--report"},
                    setup.run_limit_s);
  };
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
