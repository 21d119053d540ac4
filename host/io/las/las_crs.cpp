#include "io/las/las_crs.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

#include "core/error.hpp"
#include "io/scalar_type.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

// GeoTIFF 1.0: a directory of (key, place, count, value) after its head (1, 1, 0, count).
enum GeoKey : std::uint16_t {
  kModelType = 1024,
  kGeographic = 2048,
  kProjected = 3072,
  kLinearUnit = 3076,
  kVertical = 4096
};
constexpr std::uint16_t kModelProjected = 1, kModelGeographic = 2;
constexpr std::uint16_t kUserDefined = 32767;

std::uint16_t word(const std::string& bytes, std::size_t index) {
  return load_as<std::uint16_t>(bytes.data() + 2 * index, false);
}

// The value of a key that lies in the directory itself; 0 when it is not there.
std::uint16_t key_value(const std::string& directory, std::uint16_t key) {
  for (std::size_t at = 4; 2 * (at + 4) <= directory.size(); at += 4)
    if (word(directory, at) == key && word(directory, at + 1) == 0) return word(directory, at + 3);
  return 0;
}

std::string unit_of_code(std::uint16_t code) {
  switch (code) {
    case 9001:
      return "m";
    case 9002:
      return "ft";
    case 9003:
      return "US survey ft";
    default:
      return "";
  }
}

// The unit of lengths that a WKT names last: those of angles come before it. A vertical system may follow.
std::string unit_of_wkt(const std::string& wkt) {
  const std::string horizontal = wkt.substr(0, std::min(wkt.find("VERT_CS"), wkt.find("VERTCRS")));
  if (horizontal.find("PROJ") == horizontal.npos) return "";
  const std::size_t at = horizontal.rfind("UNIT[\"");
  if (at == horizontal.npos) return "";
  const std::size_t start = at + 6, end = horizontal.find('"', start);
  const std::string name =
      end == horizontal.npos ? "" : horizontal.substr(start, std::min<std::size_t>(end - start, 40));
  return name == "metre" || name == "meter" || name == "Meter" ? "m" : name;
}

struct EpsgCodes {
  std::uint16_t horizontal = 0, vertical = 0;  // 0 = none
};

// Of "EPSG:25832", "epsg:25832+7837", "25832" and "urn:ogc:def:crs:EPSG::25832"; none of anything else.
EpsgCodes epsg_codes(const std::string& crs) {
  std::string text = lower_case(crs);
  if (text.starts_with("urn:ogc:def:crs:epsg:")) {
    text.erase(0, text.rfind(':') + 1);  // a version may come before the code
  } else if (text.starts_with("epsg:")) {
    text.erase(0, 5);
  }
  EpsgCodes codes;
  const char* end = text.data() + text.size();
  auto parsed = std::from_chars(text.data(), end, codes.horizontal);
  if (parsed.ec == std::errc{} && parsed.ptr != end && *parsed.ptr == '+')
    parsed = std::from_chars(parsed.ptr + 1, end, codes.vertical);
  const bool good = parsed.ec == std::errc{} && parsed.ptr == end && codes.horizontal < kUserDefined &&
                    codes.vertical < kUserDefined;
  return good ? codes : EpsgCodes{};
}

void append_words(std::string& bytes, std::initializer_list<std::uint16_t> words) {
  for (const std::uint16_t value : words) {
    bytes += static_cast<char>(value & 255);
    bytes += static_cast<char>(value >> 8);
  }
}

}  // namespace

void describe_las_crs(LasHeader& header) {
  for (const CrsRecord& record : header.crs_records) {
    if (record.id == kWkt) {
      header.crs = record.bytes.substr(0, record.bytes.find('\0'));
      for (char& c : header.crs)  // the record keeps what this cannot show
        if (c < ' ' || c > '~') c = c == '\n' || c == '\t' ? ' ' : '?';
      header.unit = unit_of_wkt(header.crs);
      return;
    }
  }
  for (const CrsRecord& record : header.crs_records) {
    if (record.id != kGeoKeys) continue;
    const std::uint16_t projected = key_value(record.bytes, kProjected),
                        geographic = key_value(record.bytes, kGeographic);
    const std::uint16_t code = projected != 0 ? projected : geographic;
    const std::uint16_t vertical = key_value(record.bytes, kVertical);
    header.crs = code == 0 || code == kUserDefined           ? "GeoTIFF keys without an EPSG code"
                 : vertical == 0 || vertical == kUserDefined ? fmt::format("EPSG:{}", code)
                                                             : fmt::format("EPSG:{}+{}", code, vertical);
    header.unit = unit_of_code(key_value(record.bytes, kLinearUnit));
  }
}

bool is_wkt(const std::string& crs) {
  return !crs.empty() && std::isupper(static_cast<unsigned char>(crs[0])) != 0 && crs.find('[') != crs.npos;
}

std::vector<CrsRecord> las_crs_records(const std::string& crs) {
  constexpr std::size_t kMostBytes = 65535;  // of a record
  if (is_wkt(crs) && crs.size() < kMostBytes) return {{kWkt, crs + '\0'}};
  const auto [code, vertical] = epsg_codes(crs);
  if (code == 0) return {};
  // Codes from 4000 to 4999 are geographic systems.
  const bool geographic = code >= 4000 && code < 5000;
  CrsRecord record{kGeoKeys, ""};
  append_words(record.bytes, {1, 1, 0, static_cast<std::uint16_t>(vertical != 0 ? 3 : 2)});
  append_words(record.bytes, {kModelType, 0, 1, geographic ? kModelGeographic : kModelProjected});
  append_words(record.bytes, {geographic ? kGeographic : kProjected, 0, 1, code});
  if (vertical != 0) append_words(record.bytes, {kVertical, 0, 1, vertical});
  return {record};
}

}  // namespace hybrid::io
