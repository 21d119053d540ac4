#pragma once
#include <filesystem>
#include <string>

namespace hybrid::batch {

// The output folder of a run. summary.json is its last file: while it is not there, the run that timing.json
// names has not ended. Both name the scene, so that no other scene's results get mixed in by accident.
//
// Throws ErrorKind::input when the folder holds results of another scene (or, for scene "", of any scene; or
// a summary.json of another program), naming what is there; nothing is checked with `force`.
void check_output_folder(const std::filesystem::path& out, const std::string& scene, bool force);

// Makes the folder, says in timing.json whose run has begun and removes an older run's summary.json. Call
// when the inputs are known to be good, before the first output. Throws as io::write_text() does.
void begin_output(const std::filesystem::path& out, const std::string& scene);

}  // namespace hybrid::batch
