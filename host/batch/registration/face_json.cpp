#include "batch/registration/face_json.hpp"

namespace hybrid::batch {

using Json = nlohmann::ordered_json;

Json face_offsets_json(const stages::FaceOffsets& offsets, bool jointly) {
  constexpr std::size_t kMost = 200;
  Json faces = Json::array();
  for (const auto& face : offsets.faces) {
    if (faces.size() == kMost) break;
    faces.push_back({{"face", face.name},
                     {"index", face.face},
                     {"offset_m", face.offset_m},
                     {"sigma_m", face.sigma_m},
                     {"pose_sigma_m", face.pose_sigma_m},
                     {"tilt_deg", face.tilt_deg},
                     {"area_m2", face.area_m2},
                     {"samples", face.samples},
                     {"words", stages::offset_in_words(face)}});
  }
  Json json = {{"solved_with_the_pose", jointly},          {"agree", offsets.agree},
               {"disagreement_m", offsets.disagreement_m}, {"unobservable", stages::kUnobservable},
               {"faces_seen", offsets.faces.size()},       {"faces", faces}};
  if (!offsets.note.empty()) json["note"] = offsets.note;
  return json;
}

}  // namespace hybrid::batch
