#pragma once
#include "batch/scan_unit.hpp"
#include "geometry/polygon_model.hpp"
#include "stages/editing/openings.hpp"

namespace hybrid::batch {

// What a person checks edits by. All RGB.

// The proxy before (left) and after (right) where its faces changed, from before and above, and from behind.
Image8 edited_model_picture(device::Queue& queue, const PolygonModel& before, const PolygonModel& after);

// The range picture before (top) and after (below), with clipped samples red.
Image8 clipped_picture(const RangeImage& image, const std::vector<std::uint8_t>& clipped);

// Shaded relief of a range image as if lit from the upper left: depth edits show as steps. Before above.
Image8 relief_picture(const RangeImage& before, const RangeImage& after);

// A face from its front: grey where samples lie on it, dark grey before it, blue where lines of sight pass,
// light blue where they end in a reveal, black where nothing tells; rings of openings in red (cut), orange
// (reported).
Image8 openings_picture(const PolygonModel& model, const stages::FaceEvidence& face,
                        const std::vector<stages::Opening>& openings);

}  // namespace hybrid::batch
