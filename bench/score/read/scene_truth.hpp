#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "score/geometry.hpp"
#include "score/read/camera.hpp"

namespace score {

// What a truth sample hit.
enum Kind : std::uint8_t { kPlanar = 0, kCurved = 1, kMixed = 2, kGhost = 3, kNotMeasured = 255 };

struct TruePlane {
  std::uint32_t id = 0;
  std::string name;
  Plane in_world;
};

struct TrueScan {
  std::string id;
  Similarity world_from_scan;
  std::filesystem::path image;
  std::size_t samples = 0;
};

struct TrueView {
  Camera camera;
  std::filesystem::path picture;
};

struct TrueOpening {
  std::string name, face;
  std::vector<Vec3> ring;  // world
};

// A thing that is no wall, by the box about it, world frame.
struct TrueSolid {
  std::string name, kind;  // "cylinder": an upright column; "turned": another solid of revolution; "box" ...
  Vec3 low, high;
};

// truth.json as hybrid-synth writes it.
struct SceneTruth {
  std::filesystem::path file, folder;
  std::string title;  // seed and preset, for people
  std::vector<TrueScan> scans;
  std::map<std::uint32_t, TruePlane> planes;
  std::vector<Camera> cameras;
  std::vector<TrueView> views;
  std::vector<TrueOpening> openings;
  std::vector<TrueSolid> solids;
};

// Throws InputError: no such file, a missing or odd part (named).
SceneTruth read_scene_truth(const std::filesystem::path& file);

// Per input sample, indexed by `source`.
struct TrueSamples {
  std::vector<std::uint32_t> plane;  // 0: none
  std::vector<std::uint8_t> kind;
  std::vector<float> range_m;  // without noise
};
TrueSamples read_true_samples(const TrueScan& scan);

}  // namespace score
