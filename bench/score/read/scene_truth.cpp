#include "score/read/scene_truth.hpp"

#include "score/error.hpp"
#include "score/read/exr_file.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

constexpr const char* kMakeAgain = "make the scene again with hybrid-synth";

std::string title_of(const nlohmann::json& document) {
  std::string title = document.contains("scene") ? document.at("scene").get<std::string>() + ", " : "";
  if (document.contains("seed")) title += fmt::format("seed {}, ", document.at("seed").dump());
  if (document.contains("preset")) title += "preset " + document.at("preset").get<std::string>();
  return title;
}

TruePlane plane_of(const nlohmann::json& entry) {
  return {entry.at("id").get<std::uint32_t>(),
          entry.at("name").get<std::string>(),
          {json_vec3(entry.at("normal")).normalized(), entry.at("offset_m").get<double>()}};
}

TrueOpening opening_of(const nlohmann::json& entry) {
  TrueOpening opening{entry.at("name").get<std::string>(), entry.at("face").get<std::string>(), {}};
  for (const auto& corner : entry.at("ring")) opening.ring.push_back(json_vec3(corner));
  if (opening.ring.size() < 3) bad_input("opening {}: expected a ring of 3 corners or more", opening.name);
  return opening;
}

}  // namespace

SceneTruth read_scene_truth(const std::filesystem::path& file) {
  return from_json(file, kMakeAgain, [&](const nlohmann::json& document) {
    SceneTruth truth;
    truth.file = file;
    truth.folder = std::filesystem::absolute(file).parent_path();
    truth.title = title_of(document);
    for (const auto& entry : document.at("scans"))
      truth.scans.push_back({entry.at("id").get<std::string>(), json_pose(entry.at("world_from_scan")),
                             truth.folder / entry.at("truth_image").get<std::string>(),
                             entry.at("samples").get<std::size_t>()});
    for (const auto& entry : document.at("planes")) {
      const TruePlane plane = plane_of(entry);
      truth.planes[plane.id] = plane;
    }
    for (const auto& entry : document.at("cameras")) truth.cameras.push_back(json_camera(entry));
    for (const auto& entry : document.at("views"))
      truth.views.push_back({json_camera(entry), truth.folder / entry.at("image").get<std::string>()});
    for (const auto& entry : document.at("openings")) truth.openings.push_back(opening_of(entry));
    for (const auto& entry : document.value("clutter", nlohmann::json::array()))
      truth.solids.push_back({entry.at("name").get<std::string>(), entry.at("kind").get<std::string>(),
                              json_vec3(entry.at("low")), json_vec3(entry.at("high"))});
    return truth;
  });
}

TrueSamples read_true_samples(const TrueScan& scan) {
  ExrFile image(scan.image);
  const std::size_t width = static_cast<std::size_t>(image.width());
  if (image.pixels() < scan.samples || image.pixels() >= scan.samples + std::max<std::size_t>(width, 1) + 1)
    bad_input("{}: expected {} samples, as truth.json says of scan {}, found {} x {} pixels; {}",
              scan.image.string(), scan.samples, scan.id, image.width(), image.height(), kMakeAgain);
  image.prepare({"plane", "range", "kind"});
  TrueSamples samples{image.uints("plane"), {}, image.floats("range")};
  const auto kinds = image.uints("kind");
  samples.plane.resize(scan.samples);
  samples.range_m.resize(scan.samples);
  samples.kind.reserve(scan.samples);
  for (std::size_t i = 0; i < scan.samples; ++i) {
    if (kinds[i] > kGhost)
      bad_input("{}: sample {}: expected a kind from 0 to 3, found {}; {}", scan.image.string(), i, kinds[i],
                kMakeAgain);
    samples.kind.push_back(static_cast<std::uint8_t>(kinds[i]));
  }
  return samples;
}

}  // namespace score
