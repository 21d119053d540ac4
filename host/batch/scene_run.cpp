#include "batch/scene_run.hpp"

#include <algorithm>
#include <future>
#include <map>

#include "batch/coverage_unit.hpp"
#include "batch/drawn_samples.hpp"
#include "batch/editing/scene_editing.hpp"
#include "batch/export/scene_export.hpp"
#include "batch/output_folder.hpp"
#include "batch/planes_json.hpp"
#include "batch/registration/joint_unit.hpp"
#include "batch/registration/landmark_sheet.hpp"
#include "batch/registration/place_sheet.hpp"
#include "batch/registration/registered_scans.hpp"
#include "batch/registration/turned_faces.hpp"
#include "batch/scene_model.hpp"
#include "batch/scene_request.hpp"
#include "batch/scene_summary.hpp"
#include "batch/timing_json.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Walks through the run; each method is one paragraph of run_scene().
class Run {
 public:
  Run(device::Queue& queue, const RunRequest& request, const WriteReport& write_report)
      : queue_(queue),
        request_(request),
        write_report_(write_report),
        stages_(request.stages),
        progress_(request.quiet) {}

  SceneRun go() {
    read_inputs();
    const OutputFolder folder(request_.out, run_.scene.name, input_files());
    for (const auto& entry : run_.scene.scans) process_file(entry);
    unit("edit", [&] { check_edited_scans(run_.scene, names_->taken()); });
    if (needs_poses()) register_all();
    if (wants("planes")) write_scans();
    if (wants("render")) render_all();
    if (wants("export")) export_all();
    if (wants("report")) report();
    progress_.finish();
    write_summary();
    if (makes_all_results()) folder.warn_of_leftovers();
    return std::move(run_);
  }

 private:
  bool wants(const std::string& stage) const { return stages_.count(stage) > 0; }
  bool makes_all_results() const {
    return run_.failures.empty() && request_.scene_views && request_.only_view.empty() &&
           std::all_of(kAllStages.begin(), kAllStages.end(), [&](const auto& stage) { return wants(stage); });
  }
  bool needs_poses() const {
    return wants("register") || wants("edit") || wants("render") || (wants("export") && run_.model);
  }
  bool needs_photographs() const {
    return run_.scene.photographs && (wants("render") || wants("export") || request_.leave_one_out);
  }
  bool colours_scans() const {
    return wants("render") && wants("planes") && run_.scene.photographs.has_value();
  }
  fs::path scan_folder(const std::string& id) const { return request_.out / "scans" / id; }

  void read_inputs() {
    run_.scene = read_scene(request_, stages_, options_);
    names_.emplace(run_.scene);
    check_edited_scans_early(run_.scene, request_.salvage);
    expect_steps();
    progress_.step("read", "scene " + run_.scene.name);
    if (run_.scene.model) {
      std::vector<io::ObjFaceNames> names;
      const PolygonModel model = read_scene_model(*run_.scene.model, names);
      run_.model = editing_.edit(run_.scene, model, names);
      check_outlines(*run_.scene.model, model, names, *run_.model);
      add_input(run_.scene.model->file);
    }
    if (needs_photographs()) {
      run_.photographs =
          read_photographs(*run_.scene.photographs, request_.salvage,
                           (std::size_t{1} << 18) * static_cast<std::size_t>(options_.render.photograph_mb));
      if (run_.model)
        place_by_landmarks(*run_.scene.photographs, *run_.model, options_.landmarks.snap_tolerance_m,
                           run_.photographs);
      for (const auto& warning : run_.photographs.warnings) warn(warning);
      for (const auto& file : run_.photographs.files)
        if (!is_scan_file(file)) add_input(file);
    }
    if (request_.leave_one_out && run_.photographs.cameras.size() < 2)
      fail_input("--leave-one-out: {}: expected at least 2 photographs, found {}", run_.scene.path.string(),
                 run_.photographs.cameras.size());
    if (run_.scene.truth) truth_ = io::read_truth(*run_.scene.truth);
  }

  // All that is read, and must not be written over.
  std::vector<fs::path> input_files() const {
    std::vector<fs::path> files = {request_.scene_file};
    for (const auto& scan : run_.scene.scans) files.push_back(scan.file);
    for (const auto& [file, hash] : hashes_) files.push_back(file);
    if (run_.scene.truth) files.push_back(*run_.scene.truth);
    return files;
  }

  void expect_steps() {
    const int steps_per_scan = 6 + (needs_poses() ? 3 : 0) + wants("planes") + colours_scans();
    progress_.expect(1 + static_cast<int>(run_.scene.scans.size()) * steps_per_scan +
                     (needs_poses() ? 3 : 0) + (wants("render") ? 1 + view_count() : 0) + wants("report"));
  }

  // Photographs left out in turn are counted when they are known.
  int view_count() const {
    if (!request_.only_view.empty()) return 1;
    return request_.scene_views ? static_cast<int>(run_.scene.views.size()) : 0;
  }

  void add_input(const fs::path& file) { add_input(file, io::fingerprint(file)); }
  void add_input(const fs::path& file, const io::FileFingerprint& print) {
    hashes_[file] = print.xxh3;
    inputs_.push_back(
        {{"file", relative_name(file, run_.scene)}, {"bytes", print.bytes}, {"xxh3", print.xxh3}});
  }

  // An E57 file may hold both; as a scan file it becomes an input when its turn comes.
  bool is_scan_file(const fs::path& file) const {
    return std::any_of(run_.scene.scans.begin(), run_.scene.scans.end(),
                       [&](const io::SceneScan& scan) { return scan.file == file; });
  }

  // Nobody watches the log: summary and page have it, too.
  void warn(const std::string& warning) {
    if (warning.empty()) return;
    log::warning("{}", warning);
    warnings_.push_back(warning);
  }

  // Runs the body of one unit: an input's or a step's error is recorded and the night goes on; a lost device,
  // a full disk or an interrupt ends the run.
  template <typename Body>
  void unit(const std::string& name, const Body& body) {
    try {
      with_context(name, body);
    } catch (const Error& error) {
      if (ends_the_run(error.kind())) throw;
      log::error("{}", error.what());
      run_.failures.push_back({name, error.what(), error.kind(), request_.command});
    }
  }

  // An entry without an index stands for every scan of its file. One scan is in memory at a time.
  void process_file(const io::SceneScan& entry) {
    const std::string name = given_name(entry);
    std::vector<io::ScanEntry> scans;
    std::future<io::FileFingerprint> print;  // taken beside the reading, where there are threads
    unit("scan " + name, [&] {
      progress_.step("read", "scan " + name);
      scans = list_scans_of(run_.scene, entry, request_.salvage);
      print = std::async(thread_count() > 1 ? std::launch::async : std::launch::deferred,
                         [&] { return io::fingerprint(entry.file); });
    });
    for (std::size_t i = 0; i < scans.size(); ++i)
      process(names_->next(entry, static_cast<int>(i), static_cast<int>(scans.size())), entry, scans[i]);
    if (print.valid()) unit("scan " + name, [&] { add_input(entry.file, print.get()); });
  }

  void process(const std::string& id, const io::SceneScan& entry, const io::ScanEntry& scan_entry) {
    unit("scan " + id, [&] {
      // What the scene file changes in a range image is in no kept scan.
      const bool edited = run_.scene.edits.moves_depths_of(id);
      auto made = request_.kept_scan && !edited ? request_.kept_scan(id) : std::nullopt;
      const EditImage edit = [&](RangeImage& image, Scan& samples) {
        editing_.edit_depths(run_.scene, id, image, samples);
      };
      if (!made)  // without an edit samples go from the file into their nodes
        made = make_planes(queue_, id, entry, scan_entry, options_, progress_, edited ? edit : EditImage());
      run_.products.push_back(std::move(made->product));
      remains_.push_back(std::move(made->remains));
      entries_.push_back(in_scan_frame(entry, run_.scene.shift));
      indices_.push_back(scan_entry.index);
    });
    run_.registrations.resize(run_.products.size());
    run_.abstentions.resize(run_.products.size());
  }

  // Each scan to the model; those that abstain to the others; all together.
  void register_all() {
    std::optional<stages::ProxyModel> model;  // as it is before openings are cut
    if (run_.model) model.emplace(*run_.model);
    // Gone once the poses are final: the scans' surfaces that others are laid on are large.
    std::optional<NeighbourRegistration> neighbours(std::in_place, queue_, model ? &*model : nullptr,
                                                    options_, run_.products);
    if (!model)
      neighbours->begin_without_model(entries_, run_.scene.shift, run_.registrations, run_.abstentions);
    else
      for (std::size_t i = 0; i < run_.products.size(); ++i)
        unit("scan " + run_.products[i].id, [&] {
          auto found = find_pose(queue_, entries_[i], *model, options_, run_.products[i], progress_);
          auto& list = found.abstained ? run_.abstentions : run_.registrations;
          list[i] = std::move(found);
        });
    const std::string all = "scene " + run_.scene.name;
    unit("joint registration", [&] {
      progress_.step("joint registration", all);
      neighbours->carry(run_.registrations, run_.abstentions);
      neighbours->refine(run_.registrations, run_.abstentions);
      joint_ = neighbours->figures();
    });
    neighbours.reset();
    if (model) {
      turned_faces_ = faces_seen_from_behind(*model, options_, run_.registrations);
      warn(turned_faces_.warning);
    }
    for (std::size_t i = 0; i < run_.products.size(); ++i)
      unit("scan " + run_.products[i].id, [&] { finish(i, model ? &*model : nullptr); });
    editing_.finish_clips(run_.scene);
    progress_.step("edit", all);
    if (run_.model)
      unit("edit", [&] {
        editing_.openings(options_.edit, options_.displacement, run_.products, run_.registrations,
                          *run_.model);
      });
    if (run_.model && wants("edit"))
      unit("edit", [&] { editing_.write(queue_, request_.out, run_.products, *run_.model); });
    progress_.step("drawn samples", all);
    const auto glazed =
        run_.model ? editing_.glazed_openings(*run_.model) : std::vector<stages::GlazedOpening>();
    run_.contours = choose_drawn_samples(queue_, options_, run_.registrations, glazed,
                                         run_.model ? *run_.model : PolygonModel(), run_.products);
    if (!run_.model) return;
    if (needs_photographs()) place_photographs(*run_.scene.photographs, placed_scans(), run_.photographs);
    if (!wants("register")) return;
    const fs::path file = request_.out / "model" / "unexplained.obj";
    if (run_.contours.model.faces.empty())
      fs::remove(file);  // of an earlier run
    else
      io::write_obj(file, run_.contours.model);
  }

  // Scan i, whose pose is final now, if it has one.
  void finish(std::size_t i, const stages::ProxyModel* model) {
    const auto& found = run_.abstentions[i] ? run_.abstentions[i] : run_.registrations[i];
    if (!found) return;  // failed
    const fs::path folder = scan_folder(run_.products[i].id);
    if (run_.registrations[i] && model)
      finish_registration(queue_, *model, options_, run_.products[i], *run_.registrations[i], progress_);
    if (wants("register")) {
      write_pose_outputs(folder, run_.products[i], *found);
      write_registered(i);
    }
    if (run_.registrations[i])
      editing_.clip(run_.scene, *run_.registrations[i], remains_[i], run_.products[i]);
    if (wants("register")) remove_sheets(folder);
    if (run_.abstentions[i]) abstain(i);
  }

  void write_registered(std::size_t i) {
    const fs::path folder = scan_folder(run_.products[i].id);
    const auto formats = registered_formats(options_.write_registered);
    if (!run_.registrations[i]) return remove_registered_scan(folder);
    const auto read = [&] {
      Scan scan = read_again(i);
      scan.name = run_.products[i].id;
      return scan;
    };
    auto files =
        write_registered_scan(folder, formats, read, run_.registrations[i]->world_from_scan(), run_.scene);
    if (!formats.empty()) run_.registrations[i]->written = std::move(files);
  }

  std::vector<PlacedScan> placed_scans() const {
    std::vector<PlacedScan> scans;
    for (std::size_t i = 0; i < run_.products.size(); ++i)
      if (run_.registrations[i])
        scans.push_back(
            {entries_[i].file, indices_[i], run_.products[i].id, run_.registrations[i]->world_from_scan()});
    return scans;
  }

  // The scan takes no part in views; the sheets ask a person. The run's exit code tells, but of scans that
  // nobody called a scene.
  void abstain(std::size_t i) {
    const ScanRegistration& scan = *run_.abstentions[i];
    const auto& neighbours = scan.neighbour_reason;
    if (wants("register")) write_sheets(i);
    if (!run_.model) {
      const std::string reason =
          scan.refusal.empty() || neighbours.empty() ? reason_of(scan) : scan.refusal + "; " + neighbours;
      if (run_.scene.implied)
        return log::info("scan {}: no pose, it may be of another place: {}", run_.products[i].id, reason);
      fail_input("no pose: {}", reason);
    }
    fail_input("{}{}{}",
               scan.refusal.empty() ? "no landmarks and no pose, and the automatic alignment abstains: " : "",
               reason_of(scan), neighbours.empty() ? "" : "; " + neighbours);
  }

  void write_sheets(std::size_t i) {
    const ScanRegistration& scan = *run_.abstentions[i];
    const PolygonModel* model = run_.model ? &*run_.model : nullptr;
    const fs::path folder = scan_folder(run_.products[i].id);
    if (model != nullptr || !scan.places.empty()) write_scan_sheet(folder, run_.products[i]);
    if (model != nullptr)
      write_landmark_sheet(queue_, folder, run_.products[i], *model,
                           scan.automatic.value_or(stages::AutomaticAlignment{}));
    write_place_sheet(folder, i, run_.products, run_.registrations, scan, model, entries_[i]);
  }

  void write_scans() {
    for (std::size_t i = 0; i < run_.products.size(); ++i)
      unit("scan " + run_.products[i].id, [&] {
        const auto& product = run_.products[i];
        progress_.step("write", "scan " + product.id);
        if (wants("planes"))
          write_plane_outputs(scan_folder(product.id), product, remains_[i], exr_attributes(i));
        write_detail(scan_folder(product.id), product, remains_[i], nullptr);
        if (options_.lossless && wants("planes"))
          run_.products[i].sample_file = write_samples(scan_folder(product.id), product, remains_[i]);
        write_references(scan_folder(product.id), entries_[i].file, indices_[i], request_.salvage);
      });
  }

  std::map<std::string, std::string> exr_attributes(std::size_t i) const {
    std::map<std::string, std::string> attributes = {{"source", relative_name(entries_[i].file, run_.scene)}};
    if (const auto hash = hashes_.find(entries_[i].file); hash != hashes_.end())
      attributes["hash"] = hash->second;
    if (!run_.scene.crs.empty()) attributes["crs"] = run_.scene.crs;
    if (run_.registrations[i])
      attributes["world_from_scan"] = Json(row_major(run_.registrations[i]->world_from_scan())).dump();
    return attributes;
  }

  std::vector<io::SceneView> views() const {
    std::vector<io::SceneView> views;
    for (const auto& view : run_.scene.views)
      if (request_.only_view.empty() ? request_.scene_views
                                     : view.name == request_.only_view || view.path == request_.only_view)
        views.push_back(view);
    if (request_.leave_one_out)
      for (auto& view : leave_one_out_views(run_.photographs)) views.push_back(std::move(view));
    for (auto& view : views) view.show = request_.show.value_or(view.show);
    return views;
  }

  void render_all() {
    progress_.step("render", "scene " + run_.scene.name);
    const auto requested = views();
    if (requested.empty() && run_.photographs.cameras.empty()) return;
    const auto scene = build_render_scene(*run_.model, run_.products, run_.registrations, run_.photographs,
                                          run_.contours, options_.render.unseen_m);
    stages::Renderer renderer(queue_, scene, options_.render);
    sigma_ = sigma_figures(renderer);
    if (options_.render.equalise) equalisation_ = equalisation_figures(renderer, run_.photographs);
    for (const auto& warning : disagreements(renderer, run_.photographs)) warn(warning);
    warn(red_views(requested, run_.photographs));
    if (!run_.photographs.cameras.empty())
      unit("coverage", [&] { coverage_ = coverage_figures(renderer, scene, options_.coverage); });
    if (request_.leave_one_out) progress_.expect(static_cast<int>(run_.photographs.cameras.size()));
    for (const auto& view : requested)
      unit("view " + view.name, [&] {
        progress_.step("render", "view " + view.name);
        views_.push_back(render_view(renderer, view, run_.photographs, request_.out));
      });
    warn(empty_views(views_));
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
        write_detail(scan_folder(product.id), product, remains_[i], &colours);
      });
    }
  }

  void export_all() {
    const PolygonModel no_model;
    const ExportInputs inputs{run_.scene,
                              run_.model ? *run_.model : no_model,
                              run_.photographs,
                              run_.products,
                              run_.registrations,
                              run_.contours,
                              remains_,
                              [&](std::size_t i) { return std::optional(read_again(i)); },
                              options_};
    std::optional<SceneExport> scene_export;
    unit("export", [&] {
      progress_.step("export", "scene " + run_.scene.name);
      scene_export.emplace(queue_, inputs, request_.out);
    });
    if (!scene_export) return;
    progress_.expect(static_cast<int>(scene_export->formats().size()));
    for (const auto& format : scene_export->formats())
      unit("export " + format, [&] {
        progress_.step("export", format);
        scene_export->write(format);
      });
    unit("export", [&] { export_ = scene_export->finish(); });
  }

  // A product's input as process() had it.
  Scan read_again(std::size_t i) const {
    io::SceneScan entry = entries_[i];
    entry.index = static_cast<int>(indices_[i]);
    return read_scene_scan(run_.products[i].id, entry, list_scene_scans(entry, request_.salvage).front());
  }

  void report() {
    make_summary();
    unit("report", [&] {
      progress_.step("report", "scene " + run_.scene.name);
      write_report_(run_);
    });
  }

  void make_summary() {
    run_.summary = {{"program", {{"name", "hybrid"}, {"version", HYBRID_VERSION}}},
                    {"scene", run_.scene.name},
                    {"inputs", inputs_},
                    {"options", describe(options_)},
                    {"scans", scan_summaries(run_, truth_ ? &*truth_ : nullptr)},
                    {"views", views_},
                    {"failures", Json::array()}};
    if (!export_.is_null()) run_.summary["export"] = export_;
    if (!coverage_.is_null()) run_.summary["coverage"] = coverage_;
    if (!equalisation_.is_null()) run_.summary["equalisation"] = equalisation_;
    if (!sigma_.is_null()) run_.summary["sigma"] = sigma_;
    if (const Json edits = editing_.figures(); !edits.is_null()) run_.summary["edit"] = edits;
    if (run_.scene.photographs) describe_photographs(*run_.scene.photographs, run_.photographs, run_.summary);
    if (const Json scores = leave_one_out_figures(views_); !scores.is_null())
      run_.summary["leave_one_out"] = scores;
    if (!joint_.is_null()) run_.summary["joint"] = joint_;
    if (!turned_faces_.names.empty()) run_.summary["faces_seen_from_behind"] = turned_faces_.names;
    if (!warnings_.empty()) run_.summary["warnings"] = warnings_;
    if (!run_.scene.crs.empty()) run_.summary["crs"] = run_.scene.crs;
  }

  // summary.json last: where it is, everything else is.
  void write_summary() {
    if (run_.summary.is_null()) make_summary();
    for (const auto& failure : run_.failures)
      run_.summary["failures"].push_back({{"unit", failure.unit}, {"error", failure.error}});
    auto inputs = std::vector{request_.scene_file};
    for (const auto& input : inputs_)
      inputs.push_back(run_.scene.path.parent_path() / input["file"].get<std::string>());
    run_.timing = {{"scene", run_.scene.name}};
    run_.timing.update(timing_json(queue_, progress_, inputs, request_.out));
    for (const auto& failure : run_.failures) run_.timing["run_again"][failure.unit] = failure.command;
    write_timing(request_.out, run_.timing, wants("report"));
    io::write_text(request_.out / "summary.json", json_text(run_.summary) + "\n");
  }

  device::Queue& queue_;
  const RunRequest& request_;
  const WriteReport& write_report_;
  std::set<std::string> stages_;
  Progress progress_;
  StageOptions options_;
  SceneEditing editing_;
  std::vector<ScanRemains> remains_;    // one per product
  std::vector<io::SceneScan> entries_;  // one per product
  std::vector<std::size_t> indices_;    // one per product: which scan of its file
  std::optional<ScanNames> names_;
  std::optional<io::SceneTruth> truth_;
  std::map<fs::path, std::string> hashes_;  // of the inputs
  Json inputs_ = Json::array(), views_ = Json::array(), export_, coverage_, equalisation_, sigma_, joint_;
  TurnedFaces turned_faces_;
  std::vector<std::string> warnings_;  // of the scene as a whole; those of scans are theirs
  SceneRun run_;
};

}  // namespace

SceneRun run_scene(device::Queue& queue, const RunRequest& request, const WriteReport& write_report) {
  return Run(queue, request, write_report).go();
}

int exit_code(const SceneRun& run) {
  if (run.failures.empty()) return 0;
  return run.products.empty() ? hybrid::exit_code(run.failures.front().kind) : 3;
}

}  // namespace hybrid::batch
