#include "batch/stage_options.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// Landmark options and what the pipeline itself decides: the rows of [register] that are not ICP's.
const std::vector<OptionRow<StageOptions>>& register_rows() {
  static const std::vector<OptionRow<StageOptions>> rows = {
      {"explain_m", "m", &StageOptions::explain_m, 0.001, 10,
       "a planar sample this near a face is explained by it"},
  };
  return rows;
}

const std::vector<OptionRow<stages::LandmarkOptions>>& landmark_rows() {
  static const std::vector<OptionRow<stages::LandmarkOptions>> rows = {
      {"snap_tolerance_m", "m", &stages::LandmarkOptions::snap_tolerance_m, 0, 1000,
       "a pick farther from every model vertex is an error"},
  };
  return rows;
}

// Sets `key` in the first of `tables` that has it.
template <typename T>
bool apply(const std::string& key, const OptionValue& value, T& options,
           const std::vector<OptionRow<T>>& table) {
  const auto* row = find_option(table, key);
  if (row) set_option(options, *row, value);
  return row != nullptr;
}

template <typename Apply>
void apply_section(const io::SceneFile& scene, const std::string& section, const io::SceneOptions& options,
                   const std::string& known, const Apply& apply_key) {
  for (const auto& [key, option] : options)
    with_context(fmt::format("{}:{}: [{}]", scene.path.string(), option.line, section),
                 [&, &k = key, &o = option] {
                   if (!apply_key(k, o.value)) fail_input("unknown key '{}'; known keys: {}", k, known);
                 });
}

template <typename T>
Json describe_table(const T& options, const std::vector<OptionRow<T>>& table) {
  Json json = Json::object();
  for (const auto& row : table)
    if (row.name != "tile")  // changes no result, so it must not change summary.json
      std::visit([&](const auto& value) { json[std::string(row.name)] = value; }, get_option(options, row));
  return json;
}

}  // namespace

void StageOptions::set_tile(int tile) {
  resample.tile = squares.tile = superclusters.tile = contours.tile = decimate.tile = stray.tile = tile;
}

void StageOptions::set_seed(int seed) {
  squares.seed = icp.seed = seed;
}

void StageOptions::set_square(const OptionValue& value) {
  if (auto text = std::get_if<std::string>(&value); text && *text == "auto") {
    auto_square = true;
    return;
  }
  const auto* row = find_option(stages::square_plane_option_table(), "square");
  set_option(squares, *row, value);
  auto_square = false;
}

StageOptions read_stage_options(const io::SceneFile& scene) {
  StageOptions options;
  const auto& resample = stages::resample_option_table();
  const auto& squares = stages::square_plane_option_table();
  const auto& superclusters = stages::supercluster_option_table();
  apply_section(scene, "planes", scene.planes,
                option_names(resample) + ", " + option_names(squares) + ", " + option_names(superclusters),
                [&](const std::string& key, const OptionValue& value) {
                  if (key == "square") {
                    options.set_square(value);
                    return true;
                  }
                  return apply(key, value, options.resample, resample) ||
                         apply(key, value, options.squares, squares) ||
                         apply(key, value, options.superclusters, superclusters);
                });

  const auto& icp = stages::icp_option_table();
  const std::string register_names = "scale, " + option_names(landmark_rows()) + ", " +
                                     option_names(register_rows()) + ", " + option_names(icp);
  apply_section(scene, "register", scene.registration, register_names,
                [&](const std::string& key, const OptionValue& value) {
                  if (key == "scale") {
                    const auto scale = detail::checked_text(key, {"fixed", "free"}, value);
                    options.icp.free_scale = options.landmarks.free_scale = scale == "free";
                    return true;
                  }
                  return apply(key, value, options.landmarks, landmark_rows()) ||
                         apply(key, value, options, register_rows()) || apply(key, value, options.icp, icp);
                });

  const auto& render = stages::render_option_table();
  apply_section(scene, "render", scene.render, option_names(render),
                [&](const std::string& key, const OptionValue& value) {
                  return apply(key, value, options.render, render);
                });
  return options;
}

nlohmann::ordered_json describe(const StageOptions& options) {
  Json planes = describe_table(options.resample, stages::resample_option_table());
  planes.update(describe_table(options.squares, stages::square_plane_option_table()));
  planes.update(describe_table(options.superclusters, stages::supercluster_option_table()));
  if (options.auto_square) planes["square"] = "auto";
  Json registration = describe_table(options.icp, stages::icp_option_table());
  registration.update(describe_table(options.landmarks, landmark_rows()));
  registration.update(describe_table(options, register_rows()));
  registration["scale"] = options.icp.free_scale ? "free" : "fixed";
  return {{"planes", planes},
          {"register", registration},
          {"render", describe_table(options.render, stages::render_option_table())}};
}

}  // namespace hybrid::batch
