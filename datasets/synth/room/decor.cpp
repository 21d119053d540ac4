#include "room/room.hpp"

namespace synth {

void hang_decor(World& room, const std::vector<Recess>& recesses) {
  const auto hang = [&](const std::string& name, const Decor& decor) { synth::hang(room, name, decor); };
  const double L = room.size.x(), W = room.size.y();
  const Recess& door = recesses[0];
  const Recess& north = recesses[1];
  const double door_middle = (door.low_m + door.high_m) / 2;
  // Texture coordinates start at the wall's left end as seen from the room: x on the north wall, y on the
  // west, W - y on the east, L - x on the south.
  const double gap = (door.high_m + north.low_m) / 2;
  hang("wall-north", {Picture::sign, door_middle - 0.75, door.top_m + 0.18, 1.5, 0.3, "READING ROOM"});
  hang("wall-north", {Picture::chart, gap - 0.55, 1.15, 1.1, 1.6, "HYBRID"});
  hang("wall-north", {Picture::landscape, 0.8, 1.35, 1.7, 1.15, ""});
  hang("wall-north", {Picture::star, 0.5 * (north.high_m + L) - 0.55, 1.4, 1.1, 1.1, ""});
  hang("wall-east", {Picture::blocks, 0.66 * W, 1.45, 1.3, 1.3, ""});
  hang("wall-east", {Picture::chart, 0.86 * W, 1.45, 0.8, 1.2, "EAST"});
  hang("wall-south", {Picture::landscape, 0.10 * L, 1.45, 1.9, 1.2, ""});
  hang("wall-south", {Picture::chart, 0.34 * L, 1.3, 1.1, 1.6, "LASER"});
  hang("wall-south", {Picture::blocks, 0.58 * L, 1.4, 1.8, 1.3, ""});
  hang("wall-south", {Picture::star, 0.82 * L, 1.4, 1.2, 1.2, ""});
  hang("wall-west", {Picture::sign, 0.5 * W - 1.1, 2.75, 2.2, 0.34, "PLEASE MIND THE BEAM"});
  hang("wall-west", {Picture::landscape, 0.12 * W, 1.5, 1.6, 1.1, ""});
  hang("wall-west", {Picture::star, 0.42 * W, 1.45, 1.1, 1.1, ""});
  hang("wall-west", {Picture::chart, 0.70 * W, 1.4, 0.9, 1.3, "PHOTO"});
  hang("parcel-front", {Picture::sign, 0.06, 0.06, 0.3, 0.07, "FRAGILE"});
  hang("crate-front", {Picture::sign, 0.11, 0.24, 0.4, 0.12, "LIDAR 2004"});
  hang("crate-back", {Picture::sign, 0.11, 0.24, 0.4, 0.12, "LIDAR 2004"});
}

}  // namespace synth
