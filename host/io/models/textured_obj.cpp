#include "core/error.hpp"
#include "geometry/keyhole.hpp"
#include "io/models/gltf.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

std::string material_of(int page) {
  return page < 0 ? "plain" : fmt::format("atlas-{}", page);
}

std::string materials(const TexturedScene& scene) {
  std::string text;
  for (std::size_t page = 0; page < scene.pages.size(); ++page)
    text += fmt::format("newmtl {}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {}\n",
                        material_of(static_cast<int>(page)), scene.pages[page].file.filename().string());
  for (const TexturedMesh& mesh : scene.meshes)
    if (mesh.page < 0) return text + fmt::format("newmtl {}\nKd 0.7 0.7 0.7\nillum 1\n", material_of(-1));
  return text;
}

// Numbers from 1 over all meshes; each mesh numbers its own vertices alike for v and vt.
std::string faces(const TexturedMesh& mesh, std::size_t first, std::size_t first_texel) {
  PolygonModel model;
  model.vertices = mesh.positions;
  Face face;
  face.name = mesh.name;
  face.outer = mesh.rings.front();
  face.holes.assign(mesh.rings.begin() + 1, mesh.rings.end());
  std::string line = "f";
  for (const std::uint32_t vertex : keyhole_ring(model, face))
    line += mesh.page < 0 ? fmt::format(" {}", first + vertex)
                          : fmt::format(" {}/{}", first + vertex, first_texel + vertex);
  return line + "\n";
}

}  // namespace

void write_textured_obj(const std::filesystem::path& file, const TexturedScene& scene) {
  const auto library = std::filesystem::path(file).replace_extension(".mtl");
  std::string text = fmt::format("# metres, Z up\nmtllib {}\n", library.filename().string());
  std::size_t first = 1, first_texel = 1;
  int page = -2;
  for (const TexturedMesh& mesh : scene.meshes) {
    for (const Vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    if (mesh.page >= 0) {
      const TexturedPage& picture = scene.pages[static_cast<std::size_t>(mesh.page)];
      for (const Vec2& at : mesh.texels)
        text += fmt::format("vt {:.9g} {:.9g}\n", at.x() / picture.width, 1 - at.y() / picture.height);
    }
    if (mesh.page != page) text += fmt::format("usemtl {}\n", material_of(page = mesh.page));
    text += fmt::format("g {}\n", mesh.name);
    text += faces(mesh, first, first_texel);
    first += mesh.positions.size();
    if (mesh.page >= 0) first_texel += mesh.texels.size();
  }
  write_text(library, materials(scene));
  write_text(file, text);
}

}  // namespace hybrid::io
