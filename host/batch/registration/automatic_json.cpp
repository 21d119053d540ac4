#include "batch/registration/automatic_json.hpp"

namespace hybrid::batch {

using Json = nlohmann::ordered_json;

Json planar_area_json(const stages::SightShares& shares) {
  return {{"on_faces", shares.supported},
          {"in_front_of_faces", shares.in_front},
          {"seen_through_faces", shares.through},
          {"behind_faces", shares.behind},
          {"without_face", shares.nothing}};
}

Json automatic_json(const stages::AutomaticAlignment& alignment) {
  Json json;
  json["accepted"] = alignment.accepted;
  if (!alignment.accepted) json["reason"] = alignment.reason;
  if (!alignment.has_pose) return json;
  if (alignment.back) json["back"] = true;
  if (!alignment.accepted) json["best_world_from_scan"] = row_major(alignment.world_from_scan);
  if (const auto& told = alignment.by_samples)
    json["by_samples"] = {{"free_seen_through", told->free_seen_through},
                          {"planes_alone", told->doubt},
                          {"best_by_planes_world_from_scan", row_major(told->best_by_planes)}};
  json["margin"] = alignment.margin;
  json["planar_area"] = planar_area_json(alignment.shares);
  json["doubt"] = alignment.doubt;
  json["planes"] = alignment.planes;
  json["farthest_plane_m"] = alignment.farthest_m;
  if (alignment.seen_through) json["seen_through"] = *alignment.seen_through;
  json["hypotheses"] = {{"rotations", alignment.rotations},
                        {"poses", alignment.guesses},
                        {"looked_at_closely", alignment.finalists}};
  json["rivals"] = Json::array();
  for (const auto& rival : alignment.rivals) {
    json["rivals"].push_back({{"how", rival.words},
                              {"speaks_for_the_best", rival.comparison.for_it},
                              {"speaks_for_the_rival", rival.comparison.against_it},
                              {"without_its_largest_plane", rival.comparison.without_largest()},
                              {"strength", rival.strength},
                              {"world_from_scan", row_major(rival.world_from_scan)}});
    if (rival.seen_through) json["rivals"].back()["seen_through"] = *rival.seen_through;
  }
  return json;
}

}  // namespace hybrid::batch
