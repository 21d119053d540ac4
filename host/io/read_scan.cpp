#include "io/read_scan.hpp"

#include "core/error.hpp"
#include "io/e57/e57.hpp"
#include "io/output.hpp"
#include "io/pcd.hpp"
#include "io/ply.hpp"
#include "io/ptx.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {

std::vector<Scan> read_scans(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  if (extension == ".ptx") return read_ptx(file);
  if (extension == ".e57") return read_e57(file);
  std::vector<Scan> scans;
  if (extension == ".pcd") {
    scans.push_back(read_pcd(file));
  } else if (extension == ".ply") {
    scans.push_back(read_ply(file));
  } else {
    check_readable(file);
    const bool coming = extension == ".las" || extension == ".laz";
    fail_input("{}: expected a scan as .e57, .pcd, .ply or .ptx, found {}; {}", file.string(),
               extension.empty() ? "no extension" : extension,
               coming ? "this format is coming: until then convert it to .ptx or .ply"
                      : "convert it, or correct its extension");
  }
  return scans;
}

}  // namespace hybrid::io
