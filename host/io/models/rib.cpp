#include "io/models/rib.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "geometry/st_map.hpp"
#include "io/models/rib_shaders.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::io {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n' || c == '\r')
      out += ' ';
    else
      out += c;
  }
  return out + "\"";
}

std::string number(double value) {
  return fmt::format("{}", static_cast<float>(value));
}

// RIB's matrices take points as rows: the transpose of ours.
std::string matrix(const Mat3& rotation, const Vec3& translation) {
  std::string text = "[";
  for (int col = 0; col < 3; ++col) {
    for (int row = 0; row < 3; ++row) text += number(rotation(row, col)) + " ";
    text += "0 ";
  }
  for (int row = 0; row < 3; ++row) text += number(translation[row]) + " ";
  return text + "1]";
}

// A texture beside the picture that it is made of.
std::string texture_of(const std::string& picture) {
  return std::filesystem::path(picture).replace_extension(".tex").generic_string();
}

Vec3 choose_origin(const RibScene& scene) {
  Eigen::AlignedBox3d box;
  for (const PolygonModel* model : {&scene.proxy, &scene.contours})
    for (const Vec3& vertex : model->vertices) box.extend(vertex);
  for (const RibSphere& sphere : scene.samples) box.extend(sphere.centre);
  if (box.isEmpty() || box.center().norm() < kFarFromOrigin_m) return Vec3::Zero();
  return box.center().array().round();
}

class RibWriter {
 public:
  explicit RibWriter(const RibScene& scene) : scene_(scene), origin_(choose_origin(scene)) {}

  std::string frames() const {
    std::string text = "##RenderMan RIB-Structure 1.1\n##Creator hybrid\n" +
                       fmt::format("##Frames {}\nversion 3.03\n", scene_.views.size()) + origin_comment();
    text +=
        "# Compile hybrid_projector.sl and hybrid_blend.sl first; they must lie on the shader path.\n"
        "Option \"searchpath\" \"string shader\" [\".:&\"] \"string texture\" [\".:&\"]\n";
    for (const RibProjector& projector : scene_.projectors) {
      text += fmt::format("MakeTexture {} {} \"black\" \"black\" \"gaussian\" 2 2\n", quoted(projector.slide),
                          quoted(texture_of(projector.slide)));
      if (!projector.depth.empty())
        text += fmt::format("MakeTexture {} {} \"clamp\" \"clamp\" \"box\" 1 1\n", quoted(projector.depth),
                            quoted(texture_of(projector.depth)));
    }
    for (std::size_t i = 0; i < scene_.views.size(); ++i) text += frame(i + 1, scene_.views[i]);
    return text;
  }

  void write_world(const std::filesystem::path& file) const {
    write_atomically(file, [&](const std::filesystem::path& temporary) {
      OutputFile out(temporary);
      const auto put = [&](const std::string& text) { out.write(text.data(), text.size()); };
      put("##RenderMan RIB-Structure 1.1 Entity\n##Creator hybrid\n" + origin_comment());
      for (std::size_t i = 0; i < scene_.projectors.size(); ++i) put(light(i + 1, scene_.projectors[i]));
      put(fmt::format(
          "Sides 2\nSurface \"hybrid_blend\" \"float pixel_rad\" [{}] \"float grazing_deg\" [{}]\n",
          number(pixel_rad()), number(scene_.grazing_deg)));
      for (const PolygonModel* model : {&scene_.proxy, &scene_.contours})
        for (const Face& face : model->faces) put(polygon(*model, face));
      write_samples(put);
      out.close();
    });
  }

 private:
  std::string origin_comment() const {
    return origin_.isZero() ? "# metres, Z up\n"
                            : fmt::format("# metres, Z up; all coordinates less {} {} {}\n", origin_.x(),
                                          origin_.y(), origin_.z());
  }

  // Of the finest view: what the shader adds to every angle.
  double pixel_rad() const {
    double angle = 1;
    for (const RibView& view : scene_.views) angle = std::min(angle, 1 / view.camera.camera.fx);
    return angle < 1 ? angle : 0.001;
  }

  // RIB's camera looks along +z with y up, in left-handed coordinates: ours with y turned.
  std::string frame(std::size_t index, const RibView& view) const {
    const Camera& c = view.camera.camera;
    if (is_distorted(c) || c.panorama())
      fail(ErrorKind::failed, "scene.rib: view {}: expected a camera without distortion", view.name);
    const Mat3 flip = Vec3(1, -1, 1).asDiagonal();
    const Pose& cam_from_world = view.camera.cam_from_world;
    std::string text = fmt::format("FrameBegin {}\n# view {}\n", index, quoted(view.name));
    text += fmt::format("Display {} \"file\" \"rgba\"\nFormat {} {} 1\nPixelSamples 2 2\nExposure 1 2.2\n",
                        quoted(fmt::format("frame-{}.tif", index)), c.width, c.height);
    text += "Projection \"perspective\" \"float fov\" [90]\n";
    text += fmt::format("ScreenWindow {} {} {} {}\n", number(-c.cx / c.fx), number((c.width - c.cx) / c.fx),
                        number((c.cy - c.height) / c.fy), number(c.cy / c.fy));
    text += "Clipping 0.01 100000\nIdentity\nConcatTransform " +
            matrix(flip * cam_from_world.rotation.toRotationMatrix(), flip * (cam_from_world * origin_)) +
            "\n";
    return text + "WorldBegin\nReadArchive \"world.rib\"\nWorldEnd\nFrameEnd\n";
  }

  std::string light(std::size_t index, const RibProjector& projector) const {
    const Camera& c = projector.photograph.camera;
    const Pose world_from_cam = projector.photograph.cam_from_world.inverse();
    const double lens = c.lens == Lens::brown       ? 0
                        : c.lens == Lens::fisheye   ? 1
                        : c.lens == Lens::spherical ? 2
                                                    : 3;
    std::string text = fmt::format(
        "# photograph {}\nTransformBegin\nConcatTransform {}\n", quoted(projector.photograph.name),
        matrix(world_from_cam.rotation.toRotationMatrix(), world_from_cam.translation - origin_));
    text += fmt::format("LightSource \"hybrid_projector\" {} \"string slide\" [{}] \"string depth\" [{}]",
                        index, quoted(texture_of(projector.slide)),
                        quoted(projector.depth.empty() ? "" : texture_of(projector.depth)));
    const double largest = std::min(c.max_radius2(), 1e30);
    for (const auto& [name, value] :
         std::initializer_list<std::pair<const char*, double>>{{"lens", lens},
                                                               {"width", c.width},
                                                               {"height", c.height},
                                                               {"fx", c.fx},
                                                               {"fy", c.fy},
                                                               {"cx", c.cx},
                                                               {"cy", c.cy},
                                                               {"k1", c.k1},
                                                               {"k2", c.k2},
                                                               {"k3", c.k3},
                                                               {"k4", c.k4},
                                                               {"k5", c.k5},
                                                               {"k6", c.k6},
                                                               {"p1", c.p1},
                                                               {"p2", c.p2},
                                                               {"largest_s", largest},
                                                               {"feather", scene_.feather_px},
                                                               {"bias", scene_.tolerance_m}})
      text += fmt::format(" \"float {}\" [{}]", name, number(value));
    return text + "\nTransformEnd\n";
  }

  std::string polygon(const PolygonModel& model, const Face& face) const {
    std::vector<const std::vector<std::uint32_t>*> rings = {&face.outer};
    for (const auto& hole : face.holes) rings.push_back(&hole);
    std::string counts, points;
    for (const auto* ring : rings) {
      counts += fmt::format(" {}", ring->size());
      for (const std::uint32_t vertex : *ring) {
        const Vec3 p = model.vertices[vertex] - origin_;
        points += fmt::format(" {} {} {}", number(p.x()), number(p.y()), number(p.z()));
      }
    }
    return fmt::format(
        "AttributeBegin\nAttribute \"identifier\" \"string name\" [{}]\nGeneralPolygon [{}] \"P\" "
        "[{}]\nAttributeEnd\n",
        quoted(face.name), counts.substr(1), points.substr(1));
  }

  template <typename Put>
  void write_samples(const Put& put) const {
    if (scene_.samples.empty()) return;
    put("AttributeBegin\nAttribute \"identifier\" \"string name\" [\"samples\"]\n");
    if (!scene_.points) {
      for (const RibSphere& sphere : scene_.samples) {
        const Vec3 p = sphere.centre - origin_;
        const std::string r = number(sphere.radius_m);
        put(fmt::format("TransformBegin Translate {} {} {} Sphere {} -{} {} 360 TransformEnd\n",
                        number(p.x()), number(p.y()), number(p.z()), r, r, r));
      }
    } else {
      put("Points \"P\" [\n");
      for (const RibSphere& sphere : scene_.samples) {
        const Vec3 p = sphere.centre - origin_;
        put(fmt::format("{} {} {}\n", number(p.x()), number(p.y()), number(p.z())));
      }
      put("] \"varying float width\" [\n");
      for (const RibSphere& sphere : scene_.samples) put(number(2 * sphere.radius_m) + "\n");
      put("]\n");
    }
    put("AttributeEnd\n");
  }

  const RibScene& scene_;
  Vec3 origin_;
};

}  // namespace

void write_rib(const std::filesystem::path& folder, const RibScene& scene) {
  const RibWriter writer(scene);
  write_text(folder / "hybrid_projector.sl", kProjectorShader);
  write_text(folder / "hybrid_blend.sl", kBlendShader);
  writer.write_world(folder / "world.rib");
  write_text(folder / "scene.rib", writer.frames());
}

}  // namespace hybrid::io
