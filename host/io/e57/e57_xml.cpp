#include "io/e57/e57_xml.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "io/e57/e57_xml_values.hpp"

namespace hybrid::io {
namespace {

using Node = pugi::xml_node;

constexpr std::ptrdiff_t kMostElements = 4'000'000;  // a parsed one takes up to 100 bytes
constexpr int kDeepest = 64;
constexpr std::size_t kMostFields = 1024;
constexpr std::size_t kMostBroken = 100;  // descriptions that salvage leaves out: to place each takes a walk
constexpr double kUnit = 1e-6;            // a quaternion nearer to length 1 than this is rounding

// Names that nothing here keeps, for the user to know.
std::vector<std::string> dropped_children(const Node& node, const std::set<std::string_view>& known) {
  std::vector<std::string> dropped;
  for (const Node& child : node.children())
    if (child.type() == pugi::node_element && !known.contains(child.name())) dropped.push_back(child.name());
  return dropped;
}

Vec3 vector_of(const XmlPlace& place, const Node& node) {
  return {real_of(place, node.child("x")), real_of(place, node.child("y")), real_of(place, node.child("z"))};
}

// A pose without rotation or without translation has none of it.
std::optional<Pose> pose_of(const XmlPlace& place, const Node& owner, bool salvage,
                            std::vector<std::string>& notes) {
  const Node node = owner.child("pose");
  if (!node) return {};
  Pose pose;
  pose.translation = vector_of(place, node.child("translation"));
  double length = 1;
  if (const Node rotation = node.child("rotation")) {
    const Vec3 axis = vector_of(place, rotation);
    const double w = real_of(place, rotation.child("w"));
    pose.rotation = Eigen::Quaterniond(w, axis.x(), axis.y(), axis.z());
    length = pose.rotation.norm();
  }
  if (!(length > 0) || !std::isfinite(length) || !pose.translation.allFinite()) {
    const std::string problem =
        fmt::format("{}: expected a finite translation and a rotation other than zero, found length {}",
                    place.of(node), length);
    if (!salvage) fail_input("{}; register the scan and export it again, or use --salvage", problem);
    notes.push_back(problem + ": the pose is left out");
    return {};
  }
  if (std::abs(length - 1) > kUnit)
    notes.push_back(fmt::format("the pose's rotation has length {}: normalised", length));
  pose.rotation.normalize();
  return pose;
}

std::string sensor_of(const Node& node) {
  std::string sensor;
  for (const char* part : {"sensorVendor", "sensorModel", "sensorSerialNumber"})
    if (const std::string text = text_of(node.child(part)); !text.empty())
      sensor += (sensor.empty() ? "" : " ") + text;
  return sensor;
}

// Leaves in document order, which is the order of the streams.
void add_fields(const XmlPlace& place, const Node& parent, const std::string& prefix,
                std::vector<E57Field>& fields) {
  for (const Node& child : parent.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string name = prefix + child.name();
    if (std::string_view(child.attribute("type").value()) == "Structure") {
      add_fields(place, child, name + "/", fields);
      continue;
    }
    const auto same = [&](const E57Field& field) { return field.name == name; };
    if (std::any_of(fields.begin(), fields.end(), same))
      fail_input("{}: expected each field once, found {} again; export the file again", place.of(child),
                 name);
    fields.push_back(field_of(place, child, name));
    if (fields.size() > kMostFields)
      fail_input("{}: expected at most {} fields, found more; export the file again", place.of(child),
                 kMostFields);
  }
}

E57Table table_of(const XmlPlace& place, const Node& owner, const Node& node, std::string what) {
  if (!node) fail_input("{}: expected <points>, found none; export the file again", place.of(owner));
  E57Table table{.what = std::move(what)};
  if (std::string_view(node.attribute("type").value()) != "CompressedVector")
    fail_input("{}: expected the type CompressedVector, found \"{}\"; export the file again", place.of(node),
               node.attribute("type").value());
  table.offset = unsigned_of(place, node, "fileOffset");
  table.count = unsigned_of(place, node, "recordCount");
  add_fields(place, node.child("prototype"), "", table.fields);
  if (table.fields.empty())
    fail_input("{}: expected a prototype with fields, found none; export the file again", place.of(node));
  for (const Node& codec : node.child("codecs").children())
    if (codec.type() == pugi::node_element && !codec.child("bitPackCodec"))
      fail_input("{}: expected values packed by bits, found another codec; export the file without one",
                 place.of(codec));
  return table;
}

E57Scan scan_of(const XmlPlace& place, const Node& node, std::size_t index, bool salvage) {
  E57Scan scan{.guid = text_of(node.child("guid")),
               .name = text_of(node.child("name")),
               .description = text_of(node.child("description")),
               .sensor = sensor_of(node)};
  for (const Node& guid : node.child("originalGuids").children())
    scan.original_guids.push_back(text_of(guid));
  scan.world_from_scan = pose_of(place, node, salvage, scan.notes);
  scan.points = table_of(
      place, node, node.child("points"),
      scan.name.empty() ? fmt::format("scan {}", index) : fmt::format("scan {} ({})", index, scan.name));
  const auto limits = [&](const char* owner, const char* minimum, const char* maximum) {
    return limits_of(place, node.child(owner), minimum, maximum);
  };
  scan.intensity = limits("intensityLimits", "intensityMinimum", "intensityMaximum");
  const auto red = limits("colorLimits", "colorRedMinimum", "colorRedMaximum");
  const auto green = limits("colorLimits", "colorGreenMinimum", "colorGreenMaximum");
  const auto blue = limits("colorLimits", "colorBlueMinimum", "colorBlueMaximum");
  if (red && green && blue) scan.colour = {*red, *green, *blue};
  scan.rows = limits("indexBounds", "rowMinimum", "rowMaximum");
  scan.columns = limits("indexBounds", "columnMinimum", "columnMaximum");
  scan.returns = limits("indexBounds", "returnMinimum", "returnMaximum");
  scan.dropped =
      dropped_children(node, {"guid", "name", "description", "sensorVendor", "sensorModel",
                              "sensorSerialNumber", "pose", "points", "originalGuids", "intensityLimits",
                              "colorLimits", "indexBounds", "cartesianBounds", "sphericalBounds"});
  return scan;
}

E57Blob blob_of(const XmlPlace& place, const Node& node) {
  return {unsigned_of(place, node, "fileOffset"), unsigned_of(place, node, "length")};
}

int pixels_of(const XmlPlace& place, const Node& node) {
  const std::int64_t count = integer_of(place, node);
  if (count < 0 || count > 1'000'000)
    fail_input("{}: expected 0 to 1000000 pixels, found {}; export the file again", place.of(node), count);
  return static_cast<int>(count);
}

E57Representation representation_of(const XmlPlace& place, const Node& shown, E57Projection projection) {
  E57Representation one{.projection = projection, .png = !shown.child("jpegImage")};
  const Node picture = shown.child(one.png ? "pngImage" : "jpegImage");
  if (!picture)
    fail_input("{}: expected a jpegImage or pngImage, found none; export the file again", place.of(shown));
  one.picture = blob_of(place, picture);
  if (const Node mask = shown.child("imageMask")) one.mask = blob_of(place, mask);
  one.width = pixels_of(place, shown.child("imageWidth"));
  one.height = pixels_of(place, shown.child("imageHeight"));
  return one;
}

E57Image image_of(const XmlPlace& place, const Node& node, bool salvage) {
  E57Image image{.guid = text_of(node.child("guid")),
                 .name = text_of(node.child("name")),
                 .description = text_of(node.child("description")),
                 .sensor = sensor_of(node),
                 .scan_guid = text_of(node.child("associatedData3DGuid"))};
  image.world_from_image = pose_of(place, node, salvage, image.notes);
  // Of several representations the one that says most about the camera.
  constexpr std::pair<const char*, E57Projection> kKinds[] = {
      {"pinholeRepresentation", E57Projection::pinhole},
      {"sphericalRepresentation", E57Projection::spherical},
      {"cylindricalRepresentation", E57Projection::cylindrical},
      {"visualReferenceRepresentation", E57Projection::visual_reference}};
  Node shown;
  for (const auto& [name, projection] : kKinds) {
    if (!node.child(name)) continue;
    if (!shown) shown = node.child(name);
    image.others.push_back(representation_of(place, node.child(name), projection));
  }
  if (!shown)
    fail_input(
        "{}: expected a pinhole, spherical, cylindrical or visual reference representation, found none; "
        "export the file again",
        place.of(node));
  const E57Representation& first = image.others.front();
  image.projection = first.projection;
  image.png = first.png;
  image.picture = first.picture;
  image.mask = first.mask;
  image.width = first.width;
  image.height = first.height;
  image.others.erase(image.others.begin());
  const auto real = [&](const char* name) { return real_of(place, shown.child(name)); };
  image.focal_length_m = real("focalLength");
  image.pixel_width = real("pixelWidth");
  image.pixel_height = real("pixelHeight");
  image.principal_x = real("principalPointX");
  image.principal_y = real("principalPointY");
  image.radius_m = real("radius");
  image.dropped = dropped_children(
      node, {"guid", "name", "description", "sensorVendor", "sensorModel", "sensorSerialNumber", "pose",
             "associatedData3DGuid", "pinholeRepresentation", "sphericalRepresentation",
             "cylindricalRepresentation", "visualReferenceRepresentation"});
  return image;
}

struct DepthCheck : pugi::xml_tree_walker {
  int deepest = 0;
  bool for_each(Node&) override {
    deepest = std::max(deepest, depth());
    return deepest <= kDeepest;
  }
};

void check_bounds(const std::string& file, const std::string& text) {
  const auto elements = std::count(text.begin(), text.end(), '<');
  if (elements > kMostElements)
    fail_input(
        "{}: expected an XML section of at most {} elements, found {}; export fewer scans into one file",
        file, kMostElements, elements);
}

Node parse(const std::string& file, const std::string& text, bool salvage, pugi::xml_document& document,
           std::vector<std::string>& notes) {
  const auto result = document.load_buffer(text.data(), text.size(),
                                           pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    const auto at =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::string problem = fmt::format(
        "XML section, line {}: expected well-formed XML, found an error ({})", line, result.description());
    if (!salvage)
      fail_input("{}: {}; the file is damaged: copy or export it again, or use --salvage", file, problem);
    notes.push_back(problem + ": what came before it is used");
  }
  for (const Node& child : document.children())
    if (child.type() == pugi::node_doctype)
      fail_input("{}: XML section: expected no document type, found one; export the file again", file);
  DepthCheck depth;
  document.traverse(depth);
  if (depth.deepest > kDeepest)
    fail_input("{}: XML section: expected elements nested at most {} deep, found more; export the file again",
               file, kDeepest);
  const Node root = document.child("e57Root");
  if (!root)
    fail_input("{}: XML section: expected <e57Root>, found {}; the file is damaged: copy or export it again",
               file, document.first_child() ? "another element" : "none");
  return root;
}

// Prefixes that are used without a declaration.
void note_undeclared(const Node& root, const std::vector<E57Scan>& scans, std::vector<std::string>& notes) {
  std::set<std::string> prefixes;
  const auto look = [&](const std::string& name) {
    const auto colon = name.find(':');
    if (colon != name.npos && !root.attribute(("xmlns:" + name.substr(0, colon)).c_str()))
      prefixes.insert(name.substr(0, colon));
  };
  for (const E57Scan& scan : scans) {
    for (const E57Field& field : scan.points.fields) look(field.name);
    for (const std::string& name : scan.dropped) look(name);
  }
  for (const std::string& prefix : prefixes)
    notes.push_back(fmt::format("the extension {} is not declared: kept by name", prefix));
}

}  // namespace

E57Contents parse_e57_xml(const std::string& file, const std::string& text, bool salvage) {
  check_bounds(file, text);
  E57Contents contents;
  pugi::xml_document document;
  const Node root = parse(file, text, salvage, document, contents.notes);
  const XmlPlace place{file, text};
  contents.guid = text_of(root.child("guid"));
  contents.library = text_of(root.child("e57LibraryVersion"));
  contents.coordinate_system = text_of(root.child("coordinateMetadata"));
  for (const pugi::xml_attribute& attribute : root.attributes())
    if (const std::string name = attribute.name(); name.starts_with("xmlns:"))
      contents.extensions.push_back({name.substr(6), attribute.value()});
  // In salvage one broken description does not take the others with it.
  std::size_t broken = 0;
  const auto each = [&](const char* list, const auto& add) {
    std::size_t index = 0;
    for (const Node& node : root.child(list).children()) {
      if (node.type() != pugi::node_element) continue;
      try {
        add(node, index++);
      } catch (const Error& error) {
        if (!salvage || ++broken > kMostBroken) throw;
        contents.notes.push_back(fmt::format("left out: {}", error.what()));
      }
    }
  };
  // The reference implementation, its successor and our own writer.
  const auto made_by = [&](const char* name) { return contents.library.find(name) != std::string::npos; };
  const bool whole_words = made_by("E57RefImpl") || made_by("E57Format") || made_by("Hybrid");
  each("data3D", [&](const Node& node, std::size_t index) {
    contents.scans.push_back(scan_of(place, node, index, salvage));
    contents.scans.back().points.whole_words = whole_words;
  });
  each("images2D",
       [&](const Node& node, std::size_t) { contents.images.push_back(image_of(place, node, salvage)); });
  if (!root.child("images2D")) contents.notes.push_back("no images2D: taken as without images");
  note_undeclared(root, contents.scans, contents.notes);
  return contents;
}

E57Table parse_e57_table(const std::string& file, const std::string& element, std::string what) {
  pugi::xml_document document;
  if (!document.load_buffer(element.data(), element.size(), pugi::parse_default, pugi::encoding_utf8))
    fail_input("{}: {}: expected well-formed XML, found an error; export the file again", file, what);
  const XmlPlace place{file, element};
  return table_of(place, document, document.first_child(), std::move(what));
}

}  // namespace hybrid::io
