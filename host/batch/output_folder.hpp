#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid::batch {

// The output folder of a run. summary.json is its last file: while it is not there, the run that timing.json
// names has not ended. Both name the scene, so that no other scene's results get mixed in by accident.
//
// Throws ErrorKind::input when the folder holds results of another scene (or, for scene "" without a file, of
// any scene; or a summary.json of another program), naming what is there; nothing is checked with `force`. Of
// scenes of one name those are others whose scene file is another, as long as it is still there.
void check_output_folder(const std::filesystem::path& out, const std::string& scene,
                         const std::filesystem::path& scene_file, bool force);

// The folder while a run writes into it.
class OutputFolder {
 public:
  // Makes the folder, says in timing.json whose run has begun and removes an older run's summary.json. Call
  // when the inputs are known to be good, before the first output; of a scene its file comes first of them.
  // Throws ErrorKind::input when one of the inputs lies where results are written, ErrorKind::temporary while
  // another run writes there (the kernel drops the lock with its holder, however that ends), and as
  // io::write_text() does.
  OutputFolder(const std::filesystem::path& out, const std::string& scene,
               const std::vector<std::filesystem::path>& inputs);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // A warning that names files of an earlier run which this one, having made all its results, did not
  // replace: of scans and views that the scene no longer has, say.
  void warn_of_leftovers() const;

 private:
  std::filesystem::path out_;
  int lock_ = -1;
  std::filesystem::file_time_type begun_;
};

}  // namespace hybrid::batch
