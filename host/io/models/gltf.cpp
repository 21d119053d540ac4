#include "io/models/gltf.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::io {
namespace {

using Json = nlohmann::ordered_json;

// Constants of the format.
constexpr int kFloat = 5126, kUint32 = 5125, kUint16 = 5123;
constexpr int kVertices = 34962, kIndices = 34963;
constexpr int kPoints = 0, kTriangles = 4;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

// glTF's axes: Y up, the world's Z.
Vec3 turned(const Vec3& v) {
  return {v.x(), v.z(), -v.y()};
}
const Mat3& gltf_from_world() {
  static const Mat3 matrix = (Mat3() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();
  return matrix;
}

Json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

template <typename T>
void append_bytes(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_point(std::string& bytes, const Vec3& point) {
  for (int k = 0; k < 3; ++k) append_bytes(bytes, static_cast<float>(point[k]));
}

// The JSON document and the binary chunk, grown together.
class GlbBuilder {
 public:
  explicit GlbBuilder(const TexturedScene& scene) : scene_(scene), origin_(choose_origin(scene)) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "hybrid"}};
    Json extras = {{"up", "the world's Z is Y here, its Y is -Z"}};
    if (!scene.crs.empty()) extras["crs"] = scene.crs;
    if (!scene.shift.isZero()) extras["shift_m"] = numbers(scene.shift);
    root_["asset"]["extras"] = extras;
    root_["scene"] = 0;
    root_["scenes"] = Json::array({{{"nodes", {0}}}});
    nodes_.push_back({{"name", "world"}, {"translation", numbers(turned(origin_))}});
  }

  void add_meshes() {
    std::vector<std::vector<const TexturedMesh*>> by_page(scene_.pages.size() + 1);
    for (const TexturedMesh& mesh : scene_.meshes)
      by_page[static_cast<std::size_t>(mesh.page + 1)].push_back(&mesh);
    Json primitives = Json::array();
    for (std::size_t i = 0; i < by_page.size(); ++i)
      if (!by_page[i].empty()) primitives.push_back(primitive(by_page[i], static_cast<int>(i) - 1));
    if (primitives.empty()) return;
    add_child({{"name", "faces"}, {"mesh", add_mesh("faces", std::move(primitives))}});
    used_extensions_ = true;
  }

  void add_points() {
    if (scene_.points.empty()) return;
    const int positions = add_positions(scene_.points, [](const CloudPoint& p) { return p.position; });
    std::string bytes;
    for (const CloudPoint& point : scene_.points) {
      for (const float value : point.rgb)
        append_bytes(bytes, static_cast<std::uint16_t>(std::lround(
                                65535 * std::fmin(std::fmax(static_cast<double>(value), 0.0), 1.0))));
      append_bytes(bytes, std::uint16_t{65535});
    }
    const int colours =
        add_accessor(bytes, kVertices, kUint16, scene_.points.size(), "VEC4", {{"normalized", true}});
    const Json primitive = {{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}},
                            {"material", add_material({{"name", "points"}})},
                            {"mode", kPoints}};
    add_child({{"name", "points"}, {"mesh", add_mesh("points", Json::array({primitive}))}});
    used_extensions_ = true;
  }

  void add_cameras() {
    for (const Photograph& photograph : scene_.photographs) {
      const Pose world_from_cam = photograph.cam_from_world.inverse();
      // A glTF camera looks along -Z with Y up, ours along Z with Y down.
      const Mat3 turn = Vec3(1, -1, -1).asDiagonal();
      const Eigen::Quaterniond rotation(gltf_from_world() * world_from_cam.rotation.toRotationMatrix() *
                                        turn);
      const Camera& c = photograph.camera;
      Json node = {{"name", photograph.name},
                   {"translation", numbers(turned(world_from_cam.translation - origin_))},
                   {"rotation", {rotation.x(), rotation.y(), rotation.z(), rotation.w()}}};
      if (!c.panorama()) {
        // Without lens shift the frustum that reaches the photograph's farther borders.
        const double half = std::max(c.cy, c.height - c.cy) / c.fy;
        const double across = std::max(c.cx, c.width - c.cx) / c.fx;
        node["camera"] = cameras_.size();
        cameras_.push_back(
            {{"name", photograph.name},
             {"type", "perspective"},
             {"perspective",
              {{"aspectRatio", across / half}, {"yfov", 2 * std::atan(half)}, {"znear", 0.01}}}});
      }
      node["extras"] = {{"size_px", {c.width, c.height}},
                        {"focal_px", {c.fx, c.fy}},
                        {"centre_px", {c.cx, c.cy}},
                        {"lens", lens_name(c.lens)},
                        {"k", {c.k1, c.k2, c.k3, c.k4, c.k5, c.k6}},
                        {"p", {c.p1, c.p2}}};
      add_child(std::move(node));
    }
  }

  void add_pictures() {
    Json images = Json::array(), textures = Json::array();
    for (const TexturedPage& page : scene_.pages) {
      const bool png = page.file.extension() == ".png";
      const std::size_t view = add_view(read_text(page.file), 0);
      images.push_back({{"name", page.file.filename().string()},
                        {"mimeType", png ? "image/png" : "image/jpeg"},
                        {"bufferView", view}});
      textures.push_back({{"sampler", 0}, {"source", images.size() - 1}});
    }
    if (images.empty()) return;
    root_["images"] = images;
    root_["textures"] = textures;
    constexpr int kLinear = 9729, kMipmaps = 9987, kClamp = 33071;
    root_["samplers"] = Json::array(
        {{{"magFilter", kLinear}, {"minFilter", kMipmaps}, {"wrapS", kClamp}, {"wrapT", kClamp}}});
  }

  void write(const std::filesystem::path& file) {
    root_["nodes"] = nodes_;
    if (used_extensions_) root_["extensionsUsed"] = {"KHR_materials_unlit"};
    for (const auto& [key, list] : {std::pair{"cameras", &cameras_},
                                    {"meshes", &meshes_},
                                    {"materials", &materials_},
                                    {"accessors", &accessors_},
                                    {"bufferViews", &views_}})
      if (!list->empty()) root_[key] = *list;
    if (binary_bytes_ > 0) root_["buffers"] = Json::array({{{"byteLength", binary_bytes_}}});
    std::string json = json_text(root_, -1);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + json.size() + (binary_bytes_ > 0 ? 8 + binary_bytes_ : 0);
    if (total > std::numeric_limits<std::uint32_t>::max())
      fail_input(
          "{}: expected at most 4 GiB, the format's limit, found {} bytes; set [export] picture = \"jpeg\", "
          "or a larger texel_m or smaller atlas_page",
          file.string(), total);
    write_atomically(file, [&](const std::filesystem::path& temporary) {
      OutputFile out(temporary);
      const auto word = [&](std::uint64_t value) {
        const auto bits = static_cast<std::uint32_t>(value);
        out.write(&bits, 4);
      };
      out.write("glTF", 4);
      word(2);
      word(total);
      word(json.size());
      word(kJsonChunk);
      out.write(json.data(), json.size());
      if (binary_bytes_ > 0) {
        word(binary_bytes_);
        word(kBinaryChunk);
        for (const std::string& piece : binary_) out.write(piece.data(), piece.size());
      }
      out.close();
    });
  }

 private:
  static Vec3 choose_origin(const TexturedScene& scene) {
    Eigen::AlignedBox3d box;
    for (const TexturedMesh& mesh : scene.meshes)
      for (const Vec3& position : mesh.positions) box.extend(position);
    for (const CloudPoint& point : scene.points) box.extend(point.position);
    if (box.isEmpty() || box.center().norm() < kFarFromOrigin_m) return Vec3::Zero();
    return box.center().array().round();
  }

  static const char* lens_name(Lens lens) {
    return lens == Lens::brown       ? "brown"
           : lens == Lens::fisheye   ? "fisheye"
           : lens == Lens::spherical ? "spherical"
                                     : "cylindrical";
  }

  std::size_t add_view(std::string bytes, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", binary_bytes_}, {"byteLength", bytes.size()}};
    if (target) view["target"] = target;
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    binary_bytes_ += bytes.size();
    binary_.push_back(std::move(bytes));
    views_.push_back(view);
    return views_.size() - 1;
  }

  int add_accessor(const std::string& bytes, int target, int component, std::size_t count, const char* type,
                   const Json& more = Json::object()) {
    Json accessor = {{"bufferView", add_view(bytes, target)},
                     {"componentType", component},
                     {"count", count},
                     {"type", type}};
    accessor.update(more);
    accessors_.push_back(accessor);
    return static_cast<int>(accessors_.size()) - 1;
  }

  // The format wants the extent as the floats that are stored.
  template <typename Items, typename Position>
  int add_positions(const Items& items, const Position& position) {
    std::string bytes;
    Eigen::AlignedBox3f box;
    for (const auto& item : items) {
      const Vec3 point = turned(position(item) - origin_);
      append_point(bytes, point);
      box.extend(point.cast<float>());
    }
    return add_accessor(bytes, kVertices, kFloat, items.size(), "VEC3",
                        {{"min", numbers(box.min().template cast<double>())},
                         {"max", numbers(box.max().template cast<double>())}});
  }

  Json primitive(const std::vector<const TexturedMesh*>& meshes, int page) {
    std::vector<Vec3> positions;
    std::string normals, texels, indices;
    std::size_t index_count = 0;
    for (const TexturedMesh* mesh : meshes) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), mesh->positions.begin(), mesh->positions.end());
      for (std::size_t i = 0; i < mesh->positions.size(); ++i)
        append_point(normals, turned(mesh->normal).normalized());
      for (const Vec2& at : mesh->texels) {
        const TexturedPage& picture = scene_.pages[static_cast<std::size_t>(page)];
        append_bytes(texels, static_cast<float>(at.x() / picture.width));
        append_bytes(texels, static_cast<float>(at.y() / picture.height));
      }
      for (const std::uint32_t index : mesh->triangles) append_bytes(indices, first + index);
      index_count += mesh->triangles.size();
    }
    Json attributes = {{"POSITION", add_positions(positions, [](const Vec3& p) { return p; })},
                       {"NORMAL", add_accessor(normals, kVertices, kFloat, positions.size(), "VEC3")}};
    Json surface = {{"metallicFactor", 0}};
    if (page < 0) {
      surface["baseColorFactor"] = {0.7, 0.7, 0.7, 1};
    } else {
      attributes["TEXCOORD_0"] = add_accessor(texels, kVertices, kFloat, positions.size(), "VEC2");
      surface["baseColorTexture"] = {{"index", page}};
    }
    const std::string name = page < 0 ? "plain" : "atlas-" + std::to_string(page);
    return {{"attributes", attributes},
            {"indices", add_accessor(indices, kIndices, kUint32, index_count, "SCALAR")},
            {"material", add_material({{"name", name}, {"pbrMetallicRoughness", surface}})},
            {"mode", kTriangles}};
  }

  std::size_t add_material(Json material) {
    material["extensions"] = {{"KHR_materials_unlit", Json::object()}};
    materials_.push_back(std::move(material));
    return materials_.size() - 1;
  }
  std::size_t add_mesh(const char* name, Json primitives) {
    meshes_.push_back({{"name", name}, {"primitives", std::move(primitives)}});
    return meshes_.size() - 1;
  }
  void add_child(Json node) {
    nodes_[0]["children"].push_back(nodes_.size());
    nodes_.push_back(std::move(node));
  }

  const TexturedScene& scene_;
  Vec3 origin_;
  Json root_, nodes_ = Json::array(), cameras_ = Json::array(), meshes_ = Json::array(),
              materials_ = Json::array(), accessors_ = Json::array(), views_ = Json::array();
  std::vector<std::string> binary_;
  std::uint64_t binary_bytes_ = 0;
  bool used_extensions_ = false;
};

}  // namespace

void write_glb(const std::filesystem::path& file, const TexturedScene& scene) {
  GlbBuilder builder(scene);
  builder.add_meshes();
  builder.add_points();
  builder.add_cameras();
  builder.add_pictures();
  builder.write(file);
}

}  // namespace hybrid::io
