#include "score/score_views.hpp"

#include <algorithm>
#include <memory>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

namespace fs = std::filesystem;

// A view to score: its file, the true picture and camera, and the photograph it must not use.
struct Task {
  std::string name;
  fs::path file, picture;
  Camera camera;
  std::string left_out;
};

std::vector<Task> truth_views(const SceneTruth& truth, const fs::path& results) {
  std::vector<Task> tasks;
  for (const TrueView& view : truth.views) {
    const fs::path file = results / "views" / (view.camera.name + ".exr");
    if (fs::exists(file)) tasks.push_back({view.camera.name, file, view.picture, view.camera, ""});
  }
  return tasks;
}

std::vector<Task> left_out_views(const SceneTruth& truth, const fs::path& results) {
  const fs::path summary = results / "summary.json";
  if (!fs::exists(summary)) return {};
  return from_json(summary, "run hybrid again on the scene", [&](const nlohmann::json& document) {
    std::vector<Task> tasks;
    if (!document.contains("views")) return tasks;
    for (const auto& view : document.at("views")) {
      if (!view.contains("left_out")) continue;
      const auto name = view.at("name").get<std::string>();
      const auto photograph = view.at("left_out").at("photograph").get<std::string>();
      const auto camera = std::find_if(truth.cameras.begin(), truth.cameras.end(),
                                       [&](const Camera& known) { return known.name == photograph; });
      if (camera == truth.cameras.end())
        bad_input("view {}: expected a photograph that {} knows, found {}", name, truth.file.string(),
                  photograph);
      const fs::path file = results / "views" / (name + ".exr");
      if (fs::exists(file))
        tasks.push_back({name, file, truth.folder / "photographs" / photograph, *camera, photograph});
    }
    return tasks;
  });
}

void check(const Task& task, const ViewResult& view, const Picture& picture, std::size_t photographs) {
  const Picture& ours = view.linear;
  if (ours.width != picture.width || ours.height != picture.height)
    bad_input("{}: expected {} x {} pixels as {} has, found {} x {}; render the scene's own views",
              task.file.string(), picture.width, picture.height, task.picture.string(), ours.width,
              ours.height);
  for (std::size_t i = 0; i < view.best.size(); ++i)
    if (view.coverage[i] > 0 && view.best[i] >= photographs)
      bad_input(
          "{}: expected photographs from 0 to {} in the channel best, found {}; score the results with their "
          "own "
          "truth.json",
          task.file.string(), photographs - 1, view.best[i]);
}

ViewScore score_view(const Task& task, const SceneTruth& truth, const TrueMesh& mesh) {
  const ViewResult view = read_view_result(task.file);
  const Picture picture = read_picture(task.picture);
  check(task, view, picture, truth.cameras.size());
  std::vector<std::uint8_t> seen(view.coverage.size()), usable;
  std::transform(view.coverage.begin(), view.coverage.end(), seen.begin(),
                 [](std::uint32_t photographs) { return static_cast<std::uint8_t>(photographs > 0); });
  for (const Camera& photograph : truth.cameras) usable.push_back(photograph.name != task.left_out);
  ViewScore score;
  score.name = task.name;
  score.against = fs::proximate(task.picture, truth.folder).generic_string();
  score.pixels = static_cast<std::int64_t>(seen.size());
  score.quality = compare_pictures(view.linear, picture, seen);
  score.bleeding = score_bleeding(view, task.camera, truth.cameras, usable, mesh);
  return score;
}

}  // namespace

std::vector<ViewScore> score_views(const SceneTruth& truth, const fs::path& results) {
  std::vector<Task> tasks = truth_views(truth, results);
  for (Task& task : left_out_views(truth, results)) tasks.push_back(std::move(task));
  if (tasks.empty()) return {};
  const TrueMesh mesh(read_ply(truth.folder / "detail.ply"));
  std::vector<ViewScore> scores;
  for (const Task& task : tasks) scores.push_back(score_view(task, truth, mesh));
  return scores;
}

}  // namespace score
