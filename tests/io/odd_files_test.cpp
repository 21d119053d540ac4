// odd_files.md tells what every public sample file gives, and is compared with what it does give. After a
// change that is meant: HYBRID_UPDATE_TABLES=1 hybrid_tests --gtest_filter='OddFiles.*', and look at the
// difference.
#include <gtest/gtest.h>

#include <map>

#include "io/cameras/colmap.hpp"
#include "io/files.hpp"
#include "io/models/obj.hpp"
#include "io/read_scan.hpp"
#include "io/scan_info.hpp"
#include "io/text/text_cursor.hpp"
#include "places.hpp"

namespace hybrid::testing::odd_files_test {
namespace {
namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& parts, const char* between) {
  return fmt::format("{}", fmt::join(parts, between));
}

std::string tell_scan(const io::ScanInfo& info) {
  if (!info.problem.empty())
    return fmt::format("{} points that cannot be read: {}", info.points, info.problem);
  std::vector<std::string> parts{fmt::format("{} points", info.points)};
  if (info.returns != info.points) parts.push_back(fmt::format("{} returns", info.returns));
  if (info.grid_rows > 0) parts.push_back(fmt::format("grid {} x {}", info.grid_rows, info.grid_cols));
  if (info.has_intensity) parts.emplace_back("intensity");
  if (info.has_colour) parts.emplace_back("colour");
  if (info.world_from_scan) parts.emplace_back("pose");
  const Vec3 extent = info.max_m - info.min_m;
  parts.push_back(fmt::format("extent {:.4g} x {:.4g} x {:.4g} m", extent.x(), extent.y(), extent.z()));
  return joined(parts, ", ") + (info.notes.empty() ? "" : "; " + joined(info.notes, "; "));
}

std::string tell_scans(const fs::path& file, bool salvage) {
  std::vector<std::string> scans;
  for (const io::ScanInfo& info : io::read_scan_info(file, {.salvage = salvage}))
    scans.push_back(tell_scan(info));
  return joined(scans, " / ");
}

std::string tell_model(const fs::path& file) {
  const PolygonModel model = io::read_obj(file);
  std::size_t most = 0, holes = 0;
  for (const Face& face : model.faces) {
    most = std::max(most, face.outer.size());
    holes += face.holes.size();
  }
  return fmt::format("{} vertices, {} faces of up to {} vertices, {} holes", model.vertices.size(),
                     model.faces.size(), most, holes);
}

// One row: what `read` tells of the file, or its error without the path.
template <typename Read>
std::string told(const fs::path& file, const Read& read) {
  std::string text;
  try {
    text = read(file);
  } catch (const Error& error) {
    text = std::string("refused: ") + error.what();
  }
  for (const std::string& path : {file.string() + ": ", file.string() + ":"})
    for (std::size_t at = text.find(path); at != text.npos; at = text.find(path)) text.erase(at, path.size());
  return text;
}

// What salvage makes of it, where that is something else.
std::string told_scans(const fs::path& file) {
  const std::string strict = told(file, [](const auto& f) { return tell_scans(f, false); });
  const std::string salvaged = told(file, [](const auto& f) { return tell_scans(f, true); });
  return strict + (salvaged == strict ? "" : "; **with --salvage:** " + salvaged);
}

std::string tell_cameras(const fs::path& folder) {
  const io::CameraFile cameras = io::read_colmap(folder);
  return fmt::format("{} cameras, {} photographs", cameras.cameras.size(), cameras.photographs.size());
}

// Licences and notes; materials, which are not read; the parts of a model that is told as a whole.
bool is_no_input(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("LICENSE") || name.starts_with("README") || file.extension() == ".mtl" ||
         file.extension() == ".bin";
}

std::map<std::string, std::string> rows_of(const fs::path& data) {
  std::map<std::string, std::string> rows;
  for (const char* part : {"formats", "scans", "planes/synpeb"}) {
    for (const auto& entry : fs::recursive_directory_iterator(data / part)) {
      const fs::path& file = entry.path();
      const std::string name = fs::relative(file, data).string(),
                        extension = io::lower_case(file.extension().string());
      if (extension == ".pcd" || extension == ".ply" || extension == ".ptx" || extension == ".pts" ||
          extension == ".e57")
        rows[name] = told_scans(file);
      else if (extension == ".obj")
        rows[name] = told(file, tell_model);
      else if (fs::exists(file / "cameras.bin"))
        rows[name] = told(file, tell_cameras);
      else
        EXPECT_TRUE(entry.is_directory() || is_no_input(file)) << file << " is in no row";
    }
  }
  return rows;
}

std::string table_of(const std::map<std::string, std::string>& rows) {
  std::string text =
      "# What the public sample files give\n\n"
      "Files of ../shared/data (its README says where they are from), read as scans and polygon models. "
      "Generated\n"
      "and verified by odd_files_test.cpp.\n\n| file | gives |\n|---|---|\n";
  for (const auto& [name, what] : rows) {
    text += "| " + name + " | ";
    for (const char c : what) text += c == '|' ? std::string("\\|") : std::string(1, c);
    text += " |\n";
  }
  return text;
}

TEST(OddFiles, GiveWhatTheTableSays) {
  const fs::path data = real_data("");
  if (!fs::exists(data / "formats")) GTEST_SKIP() << "needs ../shared/data or HYBRID_DATA";
  const std::string table = table_of(rows_of(data));
  const fs::path committed = fs::path(HYBRID_PROJECT_DIR) / "tests/io/odd_files.md";
  if (std::getenv("HYBRID_UPDATE_TABLES")) std::ofstream(committed, std::ios::binary) << table;
  EXPECT_EQ(table, bytes_of(committed));
}

}  // namespace
}  // namespace hybrid::testing::odd_files_test
