#include "io/e57/e57_write_xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

namespace hybrid::io {
namespace {

constexpr const char* kNamespace = "http://www.astm.org/COMMIT/E57/2010-e57-v1.0";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:  // XML has no way to write other control characters
        if (static_cast<unsigned char>(c) >= 32 || c == '\t' || c == '\n') result += c;
    }
  }
  return result;
}

class Xml {
 public:
  explicit Xml(std::string& text) : text_(text) {}

  void open(const std::string& name, const std::string& attributes) {
    line(fmt::format("<{} {}>", name, attributes));
    names_.push_back(name);
  }
  void close() {
    const std::string name = names_.back();
    names_.pop_back();
    line(fmt::format("</{}>", name));
  }
  void structure(const char* name) { open(name, "type=\"Structure\""); }
  void list(const char* name) { open(name, "type=\"Vector\" allowHeterogeneousChildren=\"1\""); }
  void text(const char* name, const std::string& value) {
    line(fmt::format("<{0} type=\"String\">{1}</{0}>", name, escaped(value)));
  }
  void text_if(const char* name, const std::string& value) {
    if (!value.empty()) text(name, value);
  }
  void integer(const char* name, std::int64_t value) {
    line(fmt::format("<{0} type=\"Integer\">{1}</{0}>", name, value));
  }
  void real(const char* name, double value) {
    line(fmt::format("<{0} type=\"Float\">{1}</{0}>", name, value));
  }
  void line(const std::string& content) { text_ += std::string(2 * names_.size(), ' ') + content + '\n'; }

 private:
  std::string& text_;
  std::vector<std::string> names_;
};

void write_pose(Xml& xml, const std::optional<Pose>& pose) {
  if (!pose) return;
  xml.structure("pose");
  xml.structure("rotation");
  xml.real("w", pose->rotation.w());
  xml.real("x", pose->rotation.x());
  xml.real("y", pose->rotation.y());
  xml.real("z", pose->rotation.z());
  xml.close();
  xml.structure("translation");
  xml.real("x", pose->translation.x());
  xml.real("y", pose->translation.y());
  xml.real("z", pose->translation.z());
  xml.close();
  xml.close();
}

// What all limits of one structure are: integers where the fields are.
void write_limits(Xml& xml, const std::string& name, const E57Limits& limits, bool integer) {
  const auto number = [&](const std::string& which, double value) {
    if (integer)
      xml.integer((name + which).c_str(), static_cast<std::int64_t>(value));
    else
      xml.real((name + which).c_str(), value);
  };
  number("Minimum", limits.minimum);
  number("Maximum", limits.maximum);
}

std::string declaration(const E57Field& field) {
  switch (field.type) {
    case E57Type::integer:
      return fmt::format("type=\"Integer\" minimum=\"{}\" maximum=\"{}\"", field.minimum, field.maximum);
    case E57Type::scaled_integer:
      return fmt::format("type=\"ScaledInteger\" minimum=\"{}\" maximum=\"{}\" scale=\"{}\" offset=\"{}\"",
                         field.minimum, field.maximum, field.scale, field.offset);
    default: {
      std::string text = "type=\"Float\"";
      if (field.type == E57Type::single_real) text += " precision=\"single\"";
      if (field.lowest) text += fmt::format(" minimum=\"{}\"", *field.lowest);
      if (field.highest) text += fmt::format(" maximum=\"{}\"", *field.highest);
      return text;
    }
  }
}

// An element's own value must lie within its limits, and an empty one is 0.
std::string prototype_value(const E57Field& field) {
  if (field.is_integer()) return fmt::format("{}", std::clamp<std::int64_t>(0, field.minimum, field.maximum));
  return fmt::format("{}", std::max(field.lowest.value_or(0), std::min(field.highest.value_or(0), 0.0)));
}

bool is_integer(const E57Scan& scan, const std::string& name) {
  return std::ranges::any_of(scan.points.fields, [&](const E57Field& field) {
    return field.name == name && field.type == E57Type::integer;
  });
}

void write_scan(Xml& xml, const E57Scan& scan) {
  xml.structure("vectorChild");
  xml.text("guid", scan.guid);
  xml.text_if("name", scan.name);
  if (!scan.original_guids.empty()) {
    xml.open("originalGuids", "type=\"Vector\" allowHeterogeneousChildren=\"0\"");
    for (const std::string& guid : scan.original_guids) xml.text("vectorChild", guid);
    xml.close();
  }
  xml.text_if("description", scan.description);
  xml.text_if("sensorModel", scan.sensor);
  if (scan.rows || scan.columns || scan.returns) {
    xml.structure("indexBounds");
    if (scan.rows) write_limits(xml, "row", *scan.rows, true);
    if (scan.columns) write_limits(xml, "column", *scan.columns, true);
    if (scan.returns) write_limits(xml, "return", *scan.returns, true);
    xml.close();
  }
  if (scan.intensity) {
    xml.structure("intensityLimits");
    write_limits(xml, "intensity", *scan.intensity, is_integer(scan, "intensity"));
    xml.close();
  }
  if (scan.colour) {
    xml.structure("colorLimits");
    constexpr const char* kNames[] = {"colorRed", "colorGreen", "colorBlue"};
    for (std::size_t k = 0; k < 3; ++k)
      write_limits(xml, kNames[k], (*scan.colour)[k], is_integer(scan, kNames[k]));
    xml.close();
  }
  write_pose(xml, scan.world_from_scan);
  xml.open("points", fmt::format("type=\"CompressedVector\" fileOffset=\"{}\" recordCount=\"{}\"",
                                 scan.points.offset, scan.points.count));
  xml.structure("prototype");
  for (const E57Field& field : scan.points.fields)
    xml.line(fmt::format("<{0} {1}>{2}</{0}>", field.name, declaration(field), prototype_value(field)));
  xml.close();
  xml.list("codecs");
  xml.close();
  xml.close();
  xml.close();
}

void write_blob(Xml& xml, const char* name, const E57Blob& blob) {
  xml.line(
      fmt::format("<{} type=\"Blob\" fileOffset=\"{}\" length=\"{}\"/>", name, blob.offset, blob.length));
}

void write_image(Xml& xml, const E57Image& image) {
  xml.structure("vectorChild");
  xml.text("guid", image.guid);
  xml.text_if("name", image.name);
  xml.text_if("description", image.description);
  xml.text_if("sensorModel", image.sensor);
  xml.text_if("associatedData3DGuid", image.scan_guid);
  write_pose(xml, image.world_from_image);
  const bool pinhole = image.projection == E57Projection::pinhole;
  const bool cylinder = image.projection == E57Projection::cylindrical;
  const bool reference = image.projection == E57Projection::visual_reference;
  xml.structure(pinhole     ? "pinholeRepresentation"
                : cylinder  ? "cylindricalRepresentation"
                : reference ? "visualReferenceRepresentation"
                            : "sphericalRepresentation");
  write_blob(xml, image.png ? "pngImage" : "jpegImage", image.picture);
  if (image.mask) write_blob(xml, "imageMask", *image.mask);
  xml.integer("imageHeight", image.height);
  xml.integer("imageWidth", image.width);
  if (!reference) {
    xml.real("pixelHeight", image.pixel_height);
    xml.real("pixelWidth", image.pixel_width);
  }
  if (pinhole) {
    xml.real("focalLength", image.focal_length_m);
    xml.real("principalPointX", image.principal_x);
  }
  if (cylinder) xml.real("radius", image.radius_m);
  if (pinhole || cylinder) xml.real("principalPointY", image.principal_y);
  xml.close();
  xml.close();
}

// Those declared, and of the prefixes that fields use without, so that strict readers accept the file.
std::string namespaces(const E57Contents& contents) {
  std::string text;
  std::set<std::string> prefixes;
  const auto add = [&](const std::string& prefix, const std::string& address) {
    if (prefixes.insert(prefix).second)
      text += fmt::format("\n         xmlns:{}=\"{}\"", prefix, escaped(address));
  };
  for (const E57Extension& extension : contents.extensions) add(extension.prefix, extension.address);
  for (const E57Scan& scan : contents.scans)
    for (const E57Field& field : scan.points.fields)
      if (const auto colon = field.name.find(':'); colon != std::string::npos)
        add(field.name.substr(0, colon), "urn:undeclared:" + field.name.substr(0, colon));
  return text;
}

}  // namespace

bool is_xml_name(const std::string& name) {
  bool start = true;
  int prefixes = 0;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool inner = (c >= '0' && c <= '9') || c == '-' || c == '.';
    if (c == ':' ? start || ++prefixes > 1 : !(letter || (inner && !start))) return false;
    start = c == ':';
  }
  return !start;
}

std::string write_e57_xml(const E57Contents& contents, const std::optional<double>& created_gps_s) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  Xml xml(text);
  xml.open("e57Root",
           fmt::format("type=\"Structure\"\n         xmlns=\"{}\"{}", kNamespace, namespaces(contents)));
  xml.text("formatName", "ASTM E57 3D Imaging Data File");
  xml.text("guid", contents.guid);
  xml.integer("versionMajor", 1);
  xml.integer("versionMinor", 0);
  xml.text("e57LibraryVersion", contents.library);
  if (created_gps_s) {
    xml.structure("creationDateTime");
    xml.real("dateTimeValue", *created_gps_s);
    xml.integer("isAtomicClockReferenced", 0);
    xml.close();
  }
  xml.text_if("coordinateMetadata", contents.coordinate_system);
  xml.list("data3D");
  for (const E57Scan& scan : contents.scans) write_scan(xml, scan);
  xml.close();
  xml.list("images2D");
  for (const E57Image& image : contents.images) write_image(xml, image);
  xml.close();
  xml.close();
  return text;
}

}  // namespace hybrid::io
