#include "write/scene_toml.hpp"

#include <fmt/format.h>

#include "write/files.hpp"
#include "write/scan_stream.hpp"

namespace synth {
namespace {

std::string array(const Vec3& v, int decimals) {
  return fmt::format("[{:.{}f}, {:.{}f}, {:.{}f}]", v.x(), decimals, v.y(), decimals, v.z(), decimals);
}

std::string exact(const Vec3& v) {
  // TOML floats need a point; the shortest digits that come back as the same double.
  const auto number = [](double x) {
    const std::string text = fmt::format("{}", x);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  };
  return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z()));
}

std::string view_table(const View& view, const Preset& preset) {
  std::string text = fmt::format("\n[[view]]\nname = \"{}\"\n", view.name);
  if (view.photograph.empty()) {
    text += fmt::format("eye = {}\ntarget = {}\nup = [0.0, 0.0, 1.0]\nfov_deg = {:.1f}\nsize = [{}, {}]\n",
                        exact(view.eye), exact(view.target), kViewFovDeg, preset.view_width_px,
                        preset.view_height_px);
  } else {
    text += fmt::format("photograph = \"{}\"\n", view.photograph);
  }
  text += fmt::format("show = \"{}\"\ntexture = {}\n", view.show, view.texture);
  if (view.cameras) text += "cameras = true\n";
  for (const std::string& name : view.leave_out) text += fmt::format("leave_out = [\"{}\"]\n", name);
  return text;
}

}  // namespace

void write_scene_toml(const std::filesystem::path& path, const World& world, const Options& options,
                      const std::vector<std::vector<Landmark>>& landmarks_of_scan) {
  std::string text = fmt::format(
      "# Synthetic {0}, seed {1}, preset {2}.\n\n[scene]\nname = \"{0}-synthetic\"\nlevelled = false\n"
      "truth = \"truth.json\"  # for scoring only\n",
      world.kind, options.seed, options.preset.name);
  for (std::size_t i = 0; i < world.scanners.size(); ++i) {
    text += fmt::format("\n[[scan]]\nid = \"{}\"\nfile = \"scans/{}\"\n", world.scanners[i].id,
                        scan_file_name(world.scanners[i], options));
    if (landmarks_of_scan[i].empty()) {
      text += "# no landmarks: fewer than three corners of the model in sight\n";
      continue;
    }
    text += "landmarks = [\n";
    for (const Landmark& l : landmarks_of_scan[i])
      text +=
          fmt::format("  {{ scan = {}, model = {} }},\n", array(l.point_in_scan, 3), exact(l.model_vertex));
    text += "]\n";
  }
  text += "\n[model]\nfile = \"proxy.obj\"\nunit = \"m\"\nup = \"z\"\n";
  if (!world.photographs.empty() && options.scan_format == ScanFormat::e57) {
    text += "\n[photographs]\ne57 = [\"photographs.e57\"";
    for (const ScannerPose& pose : world.scanners)
      text += fmt::format(", \"scans/{}\"", scan_file_name(pose, options));
    text += "]\n";
  } else if (!world.photographs.empty()) {
    text += "\n[photographs]\ncolmap = \"cameras\"\nimages = \"photographs\"\n";
  }
  for (const View& view : world.views) text += view_table(view, options.preset);
  write_bytes(path, text);
}

}  // namespace synth
