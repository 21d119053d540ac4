#include "batch/scene_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>

#include "batch/drawn_samples.hpp"
#include "batch/planes_json.hpp"
#include "batch/truth_figures.hpp"
#include "core/log.hpp"
#include "core/parallel.hpp"
#include "io/colmap.hpp"
#include "io/obj.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Refuses the output folder of another scene, so that no summary is replaced by accident.
void check_output_folder(const RunRequest& request, const std::string& scene_name) {
  const fs::path summary = request.out / "summary.json";
  if (request.force || !fs::exists(summary)) return;
  const auto found = Json::parse(io::read_text(summary), nullptr, false).value("scene", std::string("?"));
  if (found != scene_name)
    fail_input("{}: holds the results of scene '{}', not of '{}'; choose another --out or add --force",
               request.out.string(), found, scene_name);
}

PolygonModel read_model(const io::SceneFile::Model& section) {
  const double scale = section.unit == "mm" ? 0.001 : 1.0;
  return io::read_obj(section.file, scale, section.up == "y");
}

std::string relative_name(const fs::path& file, const io::SceneFile& scene) {
  return fs::proximate(file, fs::absolute(scene.path).parent_path()).generic_string();
}

// Walks through the run; each method is one paragraph of run_scene().
class Run {
 public:
  Run(device::Queue& queue, const RunRequest& request)
      : queue_(queue), request_(request), progress_(request.quiet) {}

  SceneRun go() {
    read_inputs();
    for (const auto& entry : run_.scene.scans) process_file(entry);
    if (wants("register") || wants("render")) register_all();
    if (wants("planes") || wants("register")) write_scans();
    if (wants("render")) render_all();
    progress_.finish();
    write_summary();
    return std::move(run_);
  }

 private:
  bool wants(const std::string& stage) const { return request_.stages.count(stage) > 0; }
  bool colours_scans() const {
    return wants("render") && wants("planes") && run_.scene.photographs.has_value();
  }
  fs::path scan_folder(const std::string& id) const { return request_.out / "scans" / id; }

  void read_inputs() {
    run_.scene = io::read_scene_file(request_.scene_file);
    check_output_folder(request_, run_.scene.name);
    options_ = read_stage_options(run_.scene);
    options_.set_tile(request_.tile);
    if (request_.seed) options_.set_seed(*request_.seed);
    if (request_.square) options_.set_square(*request_.square);
    progress_.step("read", "scene " + run_.scene.name);
    if (run_.scene.model) {
      run_.model = read_model(*run_.scene.model);
      add_input(run_.scene.model->file);
    }
    if (run_.scene.photographs) {
      run_.photographs = read_photographs(*run_.scene.photographs);
      for (const auto& file : run_.photographs.files) add_input(file);
    }
    if (run_.scene.truth) truth_ = io::read_truth(*run_.scene.truth);
    if ((wants("register") || wants("render")) && !run_.model)
      fail_input("{}: no [model]: registration and rendering need one; add it, or use --only planes",
                 run_.scene.path.string());
    const int steps_per_scan = 6 + (wants("register") || wants("render") ? 3 : 0) + 1;
    progress_.expect(1 + static_cast<int>(run_.scene.scans.size()) * steps_per_scan +
                     (wants("render") ? static_cast<int>(run_.scene.views.size()) : 0) +
                     (colours_scans() ? static_cast<int>(run_.scene.scans.size()) : 0));
  }

  void add_input(const fs::path& file) {
    const auto print = io::fingerprint(file);
    inputs_.push_back(
        {{"file", relative_name(file, run_.scene)}, {"bytes", print.bytes}, {"xxh3", print.xxh3}});
  }

  // Runs the body of one unit: an input's or a step's error is recorded and the night goes on; a lost device
  // or an interrupt ends the run.
  template <typename Body>
  void unit(const std::string& name, const Body& body) {
    try {
      with_context(name, body);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted || error.kind() == ErrorKind::device) throw;
      log::error("{}", error.what());
      run_.failures.push_back(
          {name, error.what(), error.kind(),
           fmt::format("hybrid run {} --out {}", request_.scene_file.string(), request_.out.string())});
    }
  }

  // An entry without an index stands for every scan of its file.
  void process_file(const io::SceneScan& entry) {
    const std::string name = entry.id.empty() ? entry.file.filename().string() : entry.id;
    std::vector<Scan> scans;
    unit("scan " + name, [&] {
      progress_.step("read", "scan " + name);
      scans = io::read_scans(entry.file);
      add_input(entry.file);
      if (!entry.index) return;
      if (*entry.index < 0 || static_cast<std::size_t>(*entry.index) >= scans.size())
        fail_input("{}: index {}: the file holds {} scans (0-based)", entry.file.string(), *entry.index,
                   scans.size());
      Scan chosen = std::move(scans[static_cast<std::size_t>(*entry.index)]);
      scans.clear();
      scans.push_back(std::move(chosen));
    });
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const fs::path named = entry.id.empty() ? entry.file : fs::path(entry.id + ".scan");
      ids_.push_back(io::default_scan_id(named, static_cast<int>(i), static_cast<int>(scans.size()), ids_));
      process(ids_.back(), entry, std::move(scans[i]));
    }
  }

  void process(const std::string& id, const io::SceneScan& entry, Scan scan) {
    unit("scan " + id, [&] {
      run_.products.push_back(process_scan(queue_, id, scan, options_, progress_));
      sources_.push_back(std::move(scan));
      entries_.push_back(entry);
    });
    run_.registrations.resize(run_.products.size());
  }

  void register_all() {
    for (std::size_t i = 0; i < run_.products.size(); ++i)
      unit("scan " + run_.products[i].id, [&] {
        run_.registrations[i] =
            register_scan(queue_, entries_[i], *run_.model, options_, run_.products[i], progress_);
        io::write_text(scan_folder(run_.products[i].id) / "pose.json",
                       pose_json(run_.products[i], *run_.registrations[i]).dump(1) + "\n");
      });
    choose_drawn_samples(queue_, options_, run_.registrations, run_.products);
    const auto contours = world_contours(run_.products, run_.registrations);
    const fs::path file = request_.out / "model" / "unexplained.obj";
    if (contours.model.faces.empty())
      fs::remove(file);  // of an earlier run
    else
      io::write_obj(file, contours.model);
  }

  void write_scans() {
    for (std::size_t i = 0; i < run_.products.size(); ++i)
      unit("scan " + run_.products[i].id, [&] {
        const auto& product = run_.products[i];
        progress_.step("write", "scan " + product.id);
        if (wants("planes")) write_plane_outputs(scan_folder(product.id), product, exr_attributes(i));
        write_detail(scan_folder(product.id), product, sources_[i], nullptr);
      });
  }

  std::map<std::string, std::string> exr_attributes(std::size_t i) const {
    std::map<std::string, std::string> attributes = {{"source", relative_name(entries_[i].file, run_.scene)},
                                                     {"hash", io::fingerprint(entries_[i].file).xxh3}};
    if (!run_.scene.crs.empty()) attributes["crs"] = run_.scene.crs;
    if (run_.registrations[i])
      attributes["world_from_scan"] = Json(row_major(run_.registrations[i]->world_from_scan())).dump();
    return attributes;
  }

  void render_all() {
    const auto scene = build_render_scene(*run_.model, run_.products, run_.registrations, run_.photographs);
    stages::Renderer renderer(queue_, scene, options_.render);
    auto views = run_.scene.views;
    if (!request_.only_view.empty()) {
      std::erase_if(views, [&](const auto& view) { return view.name != request_.only_view; });
      if (views.empty()) fail_input("--view {}: the scene file has no view of that name", request_.only_view);
    }
    if (request_.leave_one_out) views = leave_one_out_views(run_.photographs);
    for (const auto& view : views)
      unit("view " + view.name, [&] {
        progress_.step("render", "view " + view.name);
        views_.push_back(render_view(renderer, view, run_.photographs, request_.out));
      });
    if (colours_scans()) colour_scans(renderer);
  }

  void colour_scans(stages::Renderer& renderer) {
    for (std::size_t i = 0; i < run_.products.size(); ++i) {
      if (!run_.registrations[i]) continue;
      const auto& product = run_.products[i];
      unit("scan " + product.id, [&] {
        progress_.step("colour", "scan " + product.id);
        const auto colours =
            renderer.colour_range_image(product.image, product.segmentation,
                                        run_.registrations[i]->world_from_scan(), options_.decimate.tile);
        write_node_colours(scan_folder(product.id), product, colours);
        write_detail(scan_folder(product.id), product, sources_[i], &colours);
      });
    }
  }

  Json scan_summary(std::size_t i) const {
    Json json = scan_figures(run_.products[i]);
    const auto& registration = run_.registrations[i];
    if (registration) json["registration"] = registration_figures(*registration);
    if (truth_)
      for (const auto& truth : truth_->scans)
        if (truth.id == run_.products[i].id)
          json["truth"] = truth_figures(truth, run_.products[i],
                                        registration ? &registration->world_from_scan() : nullptr);
    return json;
  }

  void write_summary() {
    Json scans = Json::array(), failures = Json::array();
    for (std::size_t i = 0; i < run_.products.size(); ++i) scans.push_back(scan_summary(i));
    for (const auto& failure : run_.failures)
      failures.push_back({{"unit", failure.unit}, {"error", failure.error}});
    run_.summary = {{"program", {{"name", "hybrid"}, {"version", HYBRID_VERSION}}},
                    {"scene", run_.scene.name},
                    {"inputs", inputs_},
                    {"options", describe(options_)},
                    {"scans", scans},
                    {"views", views_},
                    {"failures", failures}};
    if (!run_.scene.crs.empty()) run_.summary["crs"] = run_.scene.crs;

    std::array<char, 256> host{};
    gethostname(host.data(), host.size() - 1);
    Json kernels = Json::object();
    for (const auto& [label, row] : queue_.profile())
      kernels[label] = {{"launches", row.launches}, {"seconds", row.seconds}};
    run_.timing = {{"host", host.data()},
                   {"device", queue_.device().name},
                   {"threads", thread_count()},
                   {"scene_file", fs::absolute(request_.scene_file).string()},
                   {"out", fs::absolute(request_.out).string()},
                   {"seconds_by_stage", progress_.seconds_by_stage()},
                   {"kernels", kernels}};
    io::write_text(request_.out / "summary.json", run_.summary.dump(1) + "\n");
    io::write_text(request_.out / "timing.json", run_.timing.dump(1) + "\n");
  }

  device::Queue& queue_;
  const RunRequest& request_;
  Progress progress_;
  StageOptions options_;
  std::vector<Scan> sources_;           // one per product
  std::vector<io::SceneScan> entries_;  // one per product
  std::vector<std::string> ids_;        // given out so far
  std::optional<io::SceneTruth> truth_;
  Json inputs_ = Json::array(), views_ = Json::array();
  SceneRun run_;
};

}  // namespace

SceneRun run_scene(device::Queue& queue, const RunRequest& request) {
  return Run(queue, request).go();
}

std::string describe_run(const RunRequest& request) {
  const auto scene = io::read_scene_file(request.scene_file);
  read_stage_options(scene);
  check_output_folder(request, scene.name);
  std::string text = fmt::format("scene {}: {} scan entries, {} views, into {}\n", scene.name,
                                 scene.scans.size(), scene.views.size(), request.out.string());
  const auto line = [&](const char* what, const fs::path& file) {
    io::check_readable(file);
    text += fmt::format("  {} {}\n", what, file.string());
  };
  for (const auto& scan : scene.scans) line("scan", scan.file);
  if (scene.model) line("model", scene.model->file);
  if (scene.photographs)
    for (const auto& photograph : io::read_colmap(scene.photographs->colmap))
      line("photograph", scene.photographs->images / photograph.name);
  return text;
}

int exit_code(const SceneRun& run) {
  if (run.failures.empty()) return 0;
  return run.products.empty() ? hybrid::exit_code(run.failures.front().kind) : 3;
}

}  // namespace hybrid::batch
