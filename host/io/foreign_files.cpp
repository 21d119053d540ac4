#include "io/foreign_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

namespace hybrid::io {
namespace {

using std::string_view_literals::operator""sv;

struct FirstBytes {
  std::string_view bytes, extension;
};
constexpr FirstBytes kFirstBytes[] = {{"ASTM-E57"sv, ".e57"sv},
                                      {"LASF"sv, ".las"sv},
                                      {"ply\n"sv, ".ply"sv},
                                      {"ply\r"sv, ".ply"sv},
                                      {"# .PCD"sv, ".pcd"sv},
                                      {"VERSION "sv, ".pcd"sv},
                                      {"\x76\x2f\x31\x01"sv, ".exr"sv},
                                      {"\x89PNG"sv, ".png"sv},
                                      {"\xff\xd8\xff"sv, ".jpg"sv},
                                      {"PK\x03\x04"sv, ".zip"sv},
                                      {"\x1f\x8b"sv, ".gz"sv},
                                      {"7z\xbc\xaf"sv, ".7z"sv},
                                      {"\x28\xb5\x2f\xfd"sv, ".zst"sv}};

struct Foreign {
  std::string_view extensions;  // each between blanks
  std::string_view what;
};
constexpr Foreign kForeign[] = {
    {" .laz ",
     "LAZ is compressed LAS: decompress it first (laszip -i a.laz -o a.las, or pdal translate a.laz a.las)"},
    {" .fls .fws .lsproj ", "it is FARO's own format: export E57 from SCENE"},
    {" .zfs .zfprj ", "it is Zoller + Froehlich's own format: export E57 from LaserControl"},
    {" .rdbx .rdb .rxp .3dd .rsp ", "it is RIEGL's own format: export E57 from RiSCAN PRO"},
    {" .ptg .imp .lgs .lgsx .b2g .blk ", "it is Leica's own format: export E57 or PTX from Cyclone"},
    {" .tzf .tzs .rwp .rwcx .tdx .asvx ", "it is Trimble's own format: export E57 from RealWorks"},
    {" .cl3 .clr .rcp .rcs ",
     "it is a program's own format: export E57 from the program that wrote it (ReCap, ScanMaster)"},
    {" .bin ", "if it is CloudCompare's own format, save it as E57 or PLY there"},
    {" .png ", "a depth image is the file of a [[scan]] with intrinsics, in a scene file"},
    {" .toml ", "of a scene file, hybrid run SCENE.toml --out DIR --dry-run tells what is in it"},
    {" .obj ", "a model is the file of [model] in a scene file"},
    {" .stl .dxf .dwg .ifc .3dm .skp .fbx .dae .glb .gltf .3ds .rvt .off ",
     "it is a model's: export it as OBJ for [model] in a scene file"},
    {" .jpg .jpeg .tif .tiff ", "a photograph belongs to [photographs] of a scene file, with its camera"},
    {" .zip .gz .7z .zst .tar .tgz .bz2 .xz .rar ", "it is packed: unpack it first"}};

}  // namespace

std::string_view extension_by_content(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return "";  // a pipe would wait for ever
  std::array<char, 16> head{};
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), head.size());
  const std::string_view read(head.data(), static_cast<std::size_t>(in.gcount()));
  const auto found = std::find_if(std::begin(kFirstBytes), std::end(kFirstBytes),
                                  [&](const FirstBytes& known) { return read.starts_with(known.bytes); });
  return found == std::end(kFirstBytes) ? ""sv : found->extension;
}

std::string advice_on(std::string_view extension) {
  const std::string word = fmt::format(" {} ", extension);
  for (const Foreign& foreign : kForeign)
    if (foreign.extensions.find(word) != foreign.extensions.npos) return std::string(foreign.what);
  return "convert it, or correct its extension";
}

}  // namespace hybrid::io
