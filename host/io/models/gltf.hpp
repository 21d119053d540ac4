#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::io {

// Triangles in one picture; world frame, Z up, metres. One vertex per corner of a chart.
struct TexturedMesh {
  std::string name;
  int page = -1;  // of TexturedScene::pages; -1: plain grey
  std::vector<Vec3> positions;
  Vec3 normal = Vec3::UnitZ();           // of all its vertices: a mesh is one side of one face
  std::vector<Vec2> texels;              // position in the page, in its texels from the top left corner
  std::vector<std::uint32_t> triangles;  // three indices each, counter-clockwise from the front
  std::vector<std::vector<std::uint32_t>> rings;  // the outline, then its holes: for formats with polygons
};

struct TexturedPage {
  std::filesystem::path file;  // PNG or JPEG
  int width = 0, height = 0;
};

struct CloudPoint {
  Vec3 position = Vec3::Zero();
  std::array<float, 3> rgb{};  // linear
};

// What is exported as a textured model.
struct TexturedScene {
  std::vector<TexturedPage> pages;
  std::vector<TexturedMesh> meshes;
  std::vector<CloudPoint> points;
  std::vector<Photograph> photographs;
  std::string crs;  // of world + shift, or ""
  Vec3 shift = Vec3::Zero();
};

// glTF 2.0, binary, all in one file: metres, Y up (x, z, -y of the world), one primitive per page
// (KHR_materials_unlit, faces one-sided as they were seen), points as mode 0 with linear 16-bit colours, a
// node per photograph with its camera. glTF's cameras are centred and have no distortion: what is left is in
// the node's `extras`, panoramas are nodes without a camera. Coordinates are floats about a point of the
// world that the root node is moved to. Throws ErrorKind::input beyond the format's 4 GiB.
void write_glb(const std::filesystem::path& file, const TexturedScene& scene);

// OBJ and its MTL of the same stem beside it: a group per face, faces with holes as rings with a keyhole,
// pictures named by their file names, which must lie beside it. Points and cameras are not written.
void write_textured_obj(const std::filesystem::path& file, const TexturedScene& scene);

}  // namespace hybrid::io
