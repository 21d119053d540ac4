// The textured model, read again by tinygltf (glTF) and tinyobjloader (OBJ).
#include <tiny_gltf.h>
#include <tiny_obj_loader.h>

#include "batch/export/export_meshes.hpp"
#include "cases/holed_room.hpp"
#include "device.hpp"
#include "io/files.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"

namespace hybrid::testing::export_gltf_test {
namespace {

const RoomScene& room() {
  static const RoomScene instance = holed_room(8, 240, 180);
  return instance;
}

// Bakes the room's atlas into `folder` and puts the scene together as an export does.
io::TexturedScene textured(const stages::RenderScene& scene, const std::filesystem::path& folder) {
  stages::Renderer renderer(queue(), scene);
  stages::AtlasOptions options;
  options.texel_m = 0.02;
  options.page = 512;
  options.pages = 8;
  const auto atlas = stages::plan_atlas(renderer, scene, options);
  io::TexturedScene made;
  for (std::size_t page = 0; page < atlas.layout.pages.size(); ++page) {
    const auto baked = stages::bake_page(renderer, scene, atlas, static_cast<int>(page));
    const auto file = folder / ("atlas-" + std::to_string(page) + ".png");
    io::write_png(file, baked.colour);
    made.pages.push_back({file, baked.colour.width, baked.colour.height});
  }
  made.meshes = batch::textured_meshes(scene, atlas.charts);
  made.photographs = scene.photographs;
  for (const auto& splat : scene.splats)
    made.points.push_back({{splat.centre_m[0], splat.centre_m[1], splat.centre_m[2]}, {0.25f, 0.5f, 1}});
  made.crs = "EPSG:27700";
  made.shift = {530000, 180000, 0};
  return made;
}

tinygltf::Model read_glb(const std::filesystem::path& file) {
  tinygltf::Model model;
  std::string errors, warnings;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &errors, &warnings, file.string())) << errors;
  EXPECT_EQ(errors + warnings, "");
  return model;
}

template <typename T>
std::vector<T> values(const tinygltf::Model& model, int accessor) {
  const auto& a = model.accessors.at(static_cast<std::size_t>(accessor));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
  const auto& buffer = model.buffers.at(static_cast<std::size_t>(view.buffer));
  EXPECT_EQ(static_cast<std::size_t>(
                tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType))),
            sizeof(T));
  const std::size_t count =
      a.count *
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)));
  std::vector<T> out(count);
  EXPECT_LE(view.byteOffset + a.byteOffset + count * sizeof(T), buffer.data.size());
  std::memcpy(out.data(), buffer.data.data() + view.byteOffset + a.byteOffset, count * sizeof(T));
  return out;
}

Vec3 vec3(const std::vector<double>& v) {
  return {v.at(0), v.at(1), v.at(2)};
}
// Back from glTF's axes.
Vec3 z_up(const Vec3& v) {
  return {v.x(), -v.z(), v.y()};
}

// A textured triangle of the file, world frame.
struct Corner {
  Vec3 position;
  Vec2 texel;
};
struct TexturedTriangle {
  std::array<Corner, 3> corners;
  const tinygltf::Image* image;
};

std::vector<TexturedTriangle> triangles_of(const tinygltf::Model& model) {
  std::vector<TexturedTriangle> triangles;
  const Vec3 root = vec3(model.nodes.at(0).translation);
  for (const auto& mesh : model.meshes)
    for (const auto& primitive : mesh.primitives) {
      if (primitive.mode != TINYGLTF_MODE_TRIANGLES) continue;
      const auto positions = values<float>(model, primitive.attributes.at("POSITION"));
      const auto texels = values<float>(model, primitive.attributes.at("TEXCOORD_0"));
      const auto indices = values<std::uint32_t>(model, primitive.indices);
      const auto& material = model.materials.at(static_cast<std::size_t>(primitive.material));
      EXPECT_TRUE(material.extensions.count("KHR_materials_unlit"));
      const auto& texture =
          model.textures.at(static_cast<std::size_t>(material.pbrMetallicRoughness.baseColorTexture.index));
      const auto& image = model.images.at(static_cast<std::size_t>(texture.source));
      for (std::size_t i = 0; i < indices.size(); i += 3) {
        TexturedTriangle triangle{{}, &image};
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t v = indices[i + k];
          triangle.corners[k] = {
              z_up(root + Vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2])),
              Vec2(texels[2 * v] * image.width, texels[2 * v + 1] * image.height)};
        }
        triangles.push_back(triangle);
      }
    }
  return triangles;
}

// Distance and texel of a ray's nearest front-facing triangle.
struct Met {
  double distance = std::numeric_limits<double>::infinity();
  const tinygltf::Image* image = nullptr;
  Vec2 texel = Vec2::Zero();
};
Met meet(const std::vector<TexturedTriangle>& triangles, const Vec3& from, const Vec3& ray) {
  Met met;
  for (const auto& t : triangles) {
    const Vec3 a = t.corners[1].position - t.corners[0].position,
               b = t.corners[2].position - t.corners[0].position;
    const Vec3 normal = a.cross(b);
    if (!(normal.dot(ray) < 0)) continue;  // one-sided, as viewers draw them
    const double distance = normal.dot(t.corners[0].position - from) / normal.dot(ray);
    if (!(distance > 0 && distance < met.distance)) continue;
    const Vec3 at = from + distance * ray - t.corners[0].position;
    const double u = at.cross(b).dot(normal) / normal.squaredNorm(),
                 v = a.cross(at).dot(normal) / normal.squaredNorm();
    if (u < 0 || v < 0 || u + v > 1) continue;
    met = {distance, t.image,
           (1 - u - v) * t.corners[0].texel + u * t.corners[1].texel + v * t.corners[2].texel};
  }
  return met;
}

// Bilinear, of the sRGB bytes.
Vec3 lookup(const tinygltf::Image& image, const Vec2& texel) {
  const double x = texel.x() - 0.5, y = texel.y() - 0.5;
  const int col = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  Vec3 sum = Vec3::Zero();
  for (const int dy : {0, 1})
    for (const int dx : {0, 1}) {
      const int cx = std::clamp(col + dx, 0, image.width - 1), cy = std::clamp(row + dy, 0, image.height - 1);
      const double weight = (dx ? x - col : 1 - x + col) * (dy ? y - row : 1 - y + row);
      for (int k = 0; k < 3; ++k)
        sum[k] +=
            weight * image.image[static_cast<std::size_t>((cy * image.width + cx) * image.component + k)];
    }
  return sum;
}

}  // namespace

TEST(ExportGltf, its_reader_sees_the_depths_and_colours_of_the_native_view) {
  const TemporaryFolder folder;
  const auto& scene = room().scene;
  io::write_glb(folder.path() / "scene.glb", textured(scene, folder.path()));
  const auto model = read_glb(folder.path() / "scene.glb");
  const auto triangles = triangles_of(model);
  stages::ViewRequest request;
  request.camera = look_at({5.2, 4.3, 2.2}, {1.5, 1.5, 0.8}, {0, 0, 1}, 70, 96, 72);
  request.show = "proxy";
  const auto native = stages::Renderer(queue(), scene).render(request);
  const Pose world_from_cam = request.camera.cam_from_world.inverse();
  std::size_t off = 0, compared = 0;
  double square = 0, worst = 0;
  for (int row = 0; row < 72; ++row)
    for (int col = 0; col < 96; ++col) {
      const std::size_t i = static_cast<std::size_t>(row * 96 + col);
      const Vec3 ray = request.camera.camera.ray({col + 0.5, row + 0.5});
      const Met met = meet(triangles, world_from_cam.translation, world_from_cam.rotate(ray));
      const double depth = met.distance * ray.z(), expected = static_cast<double>(native.depth_m[i]);
      if (std::isinf(expected) && std::isinf(depth)) continue;
      if (!(std::abs(depth - expected) < 1e-4)) {
        ++off;  // on an outline
        continue;
      }
      worst = std::max(worst, std::abs(depth - expected));
      if (native.coverage[i] == 0) continue;
      const Vec3 colour = lookup(*met.image, met.texel);
      ++compared;
      for (int k = 0; k < 3; ++k)
        square += std::pow(
            colour[k] - 255 * srgb_from_linear(std::min(
                                  1.0, double{native.colour.pixels[3 * i + static_cast<std::size_t>(k)]})),
            2);
    }
  EXPECT_LT(off, 96u * 72u / 300u);
  EXPECT_GT(compared, 5000u);
  const double psnr = 10 * std::log10(255 * 255 * 3.0 * static_cast<double>(compared) / square);
  EXPECT_GT(psnr, 33);  // the paint looks the same from everywhere; photographs blur it at corners
  RecordProperty("psnr_db", std::to_string(psnr));
  RecordProperty("worst_depth_m", std::to_string(worst));
}

TEST(ExportGltf, vertices_points_and_cameras_stand_where_the_scene_has_them) {
  const TemporaryFolder folder;
  const auto made = textured(room().scene, folder.path());
  io::write_glb(folder.path() / "scene.glb", made);
  const auto model = read_glb(folder.path() / "scene.glb");
  // Every vertex of the proxy is there, to float rounding.
  const auto triangles = triangles_of(model);
  double worst = 0;
  for (const auto& face : room().scene.proxy.faces)
    for (const std::uint32_t vertex : face.outer) {
      double nearest = 1e9;
      for (const auto& t : triangles)
        for (const auto& corner : t.corners)
          nearest = std::min(nearest, (corner.position - room().scene.proxy.vertices[vertex]).norm());
      worst = std::max(worst, nearest);
    }
  EXPECT_LT(worst, 1e-6);
  // Their area is the faces', holes left out.
  double area = 0, expected_area = 0;
  for (const auto& t : triangles)
    area += 0.5 * (t.corners[1].position - t.corners[0].position)
                      .cross(t.corners[2].position - t.corners[0].position)
                      .norm();
  for (const auto& face : room().scene.proxy.faces) expected_area += face_area_m2(room().scene.proxy, face);
  EXPECT_NEAR(area, expected_area, 1e-4);

  const tinygltf::Primitive* points = nullptr;
  for (const auto& mesh : model.meshes)
    for (const auto& primitive : mesh.primitives)
      if (primitive.mode == TINYGLTF_MODE_POINTS) points = &primitive;
  ASSERT_TRUE(points);
  const auto positions = values<float>(model, points->attributes.at("POSITION"));
  const auto colours = values<std::uint16_t>(model, points->attributes.at("COLOR_0"));
  ASSERT_EQ(positions.size(), 3 * made.points.size());
  for (std::size_t i = 0; i < made.points.size(); ++i)
    EXPECT_LT(
        (z_up(Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2])) - made.points[i].position)
            .norm(),
        1e-6);
  EXPECT_EQ(colours[0], 16384);  // a quarter of the light, linear
  EXPECT_EQ(colours[2], 65535);

  std::size_t cameras = 0;
  for (const auto& node : model.nodes) {
    if (node.camera < 0) continue;
    const Photograph& photograph = room().scene.photographs.at(cameras++);
    EXPECT_EQ(node.name, photograph.name);
    EXPECT_LT((z_up(vec3(node.translation)) - photograph.centre()).norm(), 1e-9);
    const Eigen::Quaterniond rotation(node.rotation.at(3), node.rotation.at(0), node.rotation.at(1),
                                      node.rotation.at(2));
    const Pose world_from_cam = photograph.cam_from_world.inverse();
    EXPECT_LT((z_up(rotation * Vec3(0, 0, -1)) - world_from_cam.rotate({0, 0, 1})).norm(), 1e-9);  // forwards
    EXPECT_LT((z_up(rotation * Vec3(0, 1, 0)) - world_from_cam.rotate({0, -1, 0})).norm(), 1e-9);  // up
    const auto& camera = model.cameras.at(static_cast<std::size_t>(node.camera)).perspective;
    EXPECT_NEAR(camera.yfov, 2 * std::atan(90 / photograph.camera.fy), 1e-9);
    EXPECT_NEAR(camera.aspectRatio, 240.0 / 180, 1e-9);
    EXPECT_EQ(node.extras.Get("k").Get(0).GetNumberAsDouble(), photograph.camera.k1);
  }
  EXPECT_EQ(cameras, 8u);
  EXPECT_EQ(model.asset.extras.Get("crs").Get<std::string>(), "EPSG:27700");
}

TEST(ExportGltf, far_from_the_origin_no_digits_are_lost) {
  const TemporaryFolder folder;
  auto scene = textured(room().scene, folder.path());
  const Vec3 far(530000.25, 180000.5, 40);
  for (auto& mesh : scene.meshes)
    for (Vec3& position : mesh.positions) position += far;
  for (auto& point : scene.points) point.position += far;
  io::write_glb(folder.path() / "scene.glb", scene);
  double worst = 0;
  const auto triangles = triangles_of(read_glb(folder.path() / "scene.glb"));
  for (const auto& t : triangles)
    for (const auto& corner : t.corners) {
      double nearest = 1e9;
      for (const auto& vertex : room().scene.proxy.vertices)
        nearest = std::min(nearest, (corner.position - vertex - far).norm());
      worst = std::max(worst, nearest);
    }
  EXPECT_LT(worst, 1e-6);
}

TEST(ExportGltf, without_photographs_the_model_is_plain_and_without_anything_it_is_valid) {
  const TemporaryFolder folder;
  io::TexturedScene scene;
  io::write_glb(folder.path() / "empty.glb", scene);
  EXPECT_EQ(read_glb(folder.path() / "empty.glb").nodes.size(), 1u);
  scene.meshes = batch::plain_meshes(room().scene);
  io::write_glb(folder.path() / "plain.glb", scene);
  const auto model = read_glb(folder.path() / "plain.glb");
  ASSERT_EQ(model.meshes.size(), 1u);
  EXPECT_TRUE(model.textures.empty());
  io::write_textured_obj(folder.path() / "plain.obj", scene);
  EXPECT_EQ(io::read_obj(folder.path() / "plain.obj").faces.size(), room().scene.proxy.faces.size());
}

TEST(ExportObj, its_reader_finds_faces_holes_and_the_same_places_in_the_atlas) {
  const TemporaryFolder folder;
  const auto& proxy = room().scene.proxy;
  const auto made = textured(room().scene, folder.path());
  io::write_textured_obj(folder.path() / "scene.obj", made);
  // Our own reader: polygons, names and holes.
  const PolygonModel again = io::read_obj(folder.path() / "scene.obj");
  ASSERT_EQ(again.faces.size(), proxy.faces.size());
  for (std::size_t i = 0; i < again.faces.size(); ++i) {
    EXPECT_EQ(again.faces[i].name, proxy.faces[i].name);
    EXPECT_EQ(again.faces[i].holes.size(), proxy.faces[i].holes.size());
    EXPECT_NEAR(face_area_m2(again, again.faces[i]), face_area_m2(proxy, proxy.faces[i]), 1e-12);
  }
  // tinyobjloader: texture coordinates and materials.
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warnings, errors;
  ASSERT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors,
                               (folder.path() / "scene.obj").c_str(), (folder.path().string() + "/").c_str(),
                               false))
      << errors;
  EXPECT_EQ(warnings + errors, "");
  ASSERT_EQ(materials.size(), made.pages.size());
  ASSERT_EQ(shapes.size(), made.meshes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto& mesh = made.meshes[i];
    const int material = shapes[i].mesh.material_ids.at(0);
    EXPECT_EQ(material, mesh.page);
    EXPECT_TRUE(std::filesystem::exists(folder.path() /
                                        materials.at(static_cast<std::size_t>(material)).diffuse_texname));
    const auto& page = made.pages[static_cast<std::size_t>(mesh.page)];
    for (const auto& index : shapes[i].mesh.indices) {
      const auto v = static_cast<std::size_t>(index.vertex_index),
                 vt = static_cast<std::size_t>(index.texcoord_index);
      const Vec3 position(attributes.vertices[3 * v], attributes.vertices[3 * v + 1],
                          attributes.vertices[3 * v + 2]);
      const Vec2 texel(attributes.texcoords[2 * vt] * page.width,
                       (1 - attributes.texcoords[2 * vt + 1]) * page.height);
      double nearest = 1e9;  // of the mesh's own vertices, that one's texel
      Vec2 expected = Vec2::Zero();
      for (std::size_t k = 0; k < mesh.positions.size(); ++k)
        if (const double d = (mesh.positions[k] - position).norm(); d < nearest) {
          nearest = d;
          expected = mesh.texels[k];
        }
      EXPECT_LT(nearest, 1e-6);
      EXPECT_LT((texel - expected).norm(), 1e-3);
    }
  }
}

}  // namespace hybrid::testing::export_gltf_test
