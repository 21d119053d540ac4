#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "batch/registration/registration_unit.hpp"
#include "io/models/obj.hpp"
#include "stages/editing/displacement.hpp"
#include "stages/editing/openings.hpp"

namespace hybrid::batch {

// METHOD 9: what [edit] of the scene file says, done. The model's edits come first, so that registration,
// rendering and export all see the edited proxy; range images' depth edits before planes are looked for;
// clips once the scan is registered; openings found from evidence last.

// The model with faces removed and holes cut; `names` as read_obj gives them; `figures` gets what was done.
// Throws ErrorKind::input naming the scene file's line.
PolygonModel edit_model(const io::SceneFile& scene, const PolygonModel& model,
                        const std::vector<io::ObjFaceNames>& names, nlohmann::ordered_json& figures);

// Whether an edit names a scan that is not in `ids`; the other throws ErrorKind::input naming it.
bool edits_name_other_scans(const io::SceneFile& scene, const std::vector<std::string>& ids);
void check_edited_scans(const io::SceneFile& scene, const std::vector<std::string>& ids);

// The scene's depth edits of one scan, on its range image and on the samples beside its grid, which `scan`
// holds. Returns how many measured samples they moved.
std::int64_t edit_depths(const io::SceneFile& scene, const std::string& id, RangeImage& image, Scan& scan);
void set_point(Scan& scan, std::uint32_t sample, const Vec3& point);

// Drops what the scene's clips say from a registered scan and from its samples beside the grid: they take no
// part in detail.ply, views, exported points and openings any more; contour polygons of superclusters that
// lose samples give their other samples back. Returns figures; null when no clip concerns the scan. `dropped`
// has per clip how many samples it took from all scans so far, nothing where it concerned none.
nlohmann::ordered_json clip_scan(const io::SceneFile& scene, const ScanRegistration& registration,
                                 const ScanRemains& remains, ScanProduct& product,
                                 std::vector<std::optional<std::int64_t>>& dropped);
// Names the clips that dropped nothing.
void warn_of_idle_clips(const io::SceneFile& scene, const std::vector<std::optional<std::int64_t>>& dropped);

// Evidence of openings from all registered scans.
stages::Openings openings_of_scans(const PolygonModel& model, const std::vector<ScanProduct>& products,
                                   const std::vector<std::optional<ScanRegistration>>& registrations,
                                   const stages::OpeningOptions& options);
std::vector<stages::DisplacementMap> displacements_of_scans(
    const PolygonModel& model, const std::vector<ScanProduct>& products,
    const std::vector<std::optional<ScanRegistration>>& registrations,
    const stages::DisplacementOptions& options);
// Cuts those that are to be cut. One that the model does not take is marked as not cut.
void cut_openings(PolygonModel& model, stages::Openings& openings);
// model/openings.json.
nlohmann::ordered_json openings_json(const PolygonModel& model, const stages::Openings& openings,
                                     const stages::OpeningOptions& options);

}  // namespace hybrid::batch
