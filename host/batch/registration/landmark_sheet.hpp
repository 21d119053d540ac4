#pragma once
#include <filesystem>

#include "batch/scan_unit.hpp"
#include "stages/registration/automatic.hpp"

namespace hybrid::batch {

// What a person needs to pick landmarks for a scan whose automatic alignment abstained, in <folder>/sheet/:
// model.png, the model from two sides with numbered vertices; landmarks.toml, a stanza for the scene file to
// fill in. Of a model whose faces the scan may have seen (alignment.faces) only these are drawn.
void write_landmark_sheet(device::Queue& queue, const std::filesystem::path& folder,
                          const ScanProduct& product, const PolygonModel& model,
                          const stages::AutomaticAlignment& alignment);

// Beside it, and beside the places (place_sheet.hpp): scan.png, the range picture with a pixel grid.
void write_scan_sheet(const std::filesystem::path& folder, const ScanProduct& product);

// All of <folder>/sheet/, of an earlier run that abstained.
void remove_sheets(const std::filesystem::path& folder);

// The pictures by themselves. Rows and columns of the grid's labels are those of range.exr, every
// sheet_grid_step() nodes: 10, 20, 50, 100 ..., so that about sixteen lines cross the picture.
int sheet_grid_step(const RangeImage& image);
Image8 scan_sheet(const ScanProduct& product);
Image8 model_sheet(device::Queue& queue, const PolygonModel& model, const std::vector<std::uint32_t>& faces);

}  // namespace hybrid::batch
