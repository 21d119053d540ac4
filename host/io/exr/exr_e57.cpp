#include "io/exr/exr_e57.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cctype>

#include "core/error.hpp"
#include "io/e57/e57_stream.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/input_file.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;

// A folder's name beside the image, and nothing else that a path can say.
void check_parts(const fs::path& file, const std::string& name) {
  if (name.empty() || (fs::path(name).filename() == name && name != "." && name != "..")) return;
  fail_input("{}: header: {}: expected the name of a folder beside the image, found {}; write the file again",
             file.string(), records_attribute::kParts, in_quotes(name));
}

void check_cuts(const fs::path& file, const RecordsDescription& description) {
  const auto& cuts = description.cuts;
  if (description.scan < cuts.size() && std::is_sorted(cuts.begin(), cuts.end()) &&
      cuts.back() <= description.xml.size())
    return;
  fail_input(
      "{}: header: {}: expected a place for each scan within the {} bytes of {}, and scan {} among them, "
      "found {} "
      "places; copy or write the file again",
      file.string(), records_attribute::kCuts, description.xml.size(), records_attribute::kXml,
      description.scan, cuts.size());
}

std::string checksum(const std::vector<char>& bytes) {
  return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

// Of the blob at this offset of the original file, or "" where none was written.
std::string_view sum_at(const std::string& sums, std::uint64_t offset) {
  const std::string wanted = fmt::format("{}:", offset);
  for (const std::string_view word : words(sums))
    if (word.starts_with(wanted)) return word.substr(wanted.size());
  return {};
}

std::string describe_field(const E57Field& field) {
  switch (field.type) {
    case E57Type::integer:
      return fmt::format("{} (whole {} to {})", field.name, field.minimum, field.maximum);
    case E57Type::scaled_integer:
      return fmt::format("{} (whole {} to {}, times {}, plus {})", field.name, field.minimum, field.maximum,
                         field.scale, field.offset);
    default:
      return fmt::format("{} ({})", field.name, field.type == E57Type::single_real ? "float" : "double");
  }
}

}  // namespace

ExrSource::ExrSource(const std::vector<fs::path>& files, bool salvage) : salvage_(salvage) {
  for (const fs::path& file : files) {
    const ExrRecords records(file);
    const RecordsDescription& description = records.description();
    check_parts(file, description.parts);
    check_cuts(file, description);
    images_.push_back({file, description});
  }
  const auto scan_of = [](const Image& image) { return image.description.scan; };
  std::ranges::stable_sort(images_, {}, scan_of);
  std::vector<TextEdit> scans;
  for (std::size_t k = 0; k < images_.size(); ++k) {
    const RecordsDescription &first = images_[0].description, &one = images_[k].description;
    if (one.xml != first.xml || one.cuts != first.cuts)
      fail_input(
          "{}: expected a scan of the file that {} was made from, found another file's; convert each by "
          "itself",
          images_[k].file.string(), images_[0].file.string());
    if (k > 0 && one.scan == images_[k - 1].description.scan)
      fail_input("{}: expected scans of a file once each, found scan {} again; leave one out",
                 images_[k].file.string(), one.scan);
    scans.push_back({{one.cuts[one.scan], one.cuts[one.scan]}, one.scan_xml});
  }
  describe(images_[0].file.string(), edited(images_[0].description.xml, scans));
  if (contents().scans.size() != images_.size())
    fail_input("{}: header: {}: expected one scan, found {} in {}; copy or write the file again",
               images_[0].file.string(), records_attribute::kScanXml, contents().scans.size(),
               images_.size());
  if (salvage_) leave_out_damage();
}

std::filesystem::path ExrSource::part_file(std::size_t part) const {
  const E57Part& wanted = outline().parts.at(part);
  const Image& image = images_[wanted.scan.value_or(0)];
  if (image.description.parts.empty())
    fail_input("{}: header: {}: expected the folder with {}, found none; write the file again",
               image.file.string(), records_attribute::kParts, part_name(wanted));
  const fs::path file = image.file.parent_path() / image.description.parts / part_name(wanted);
  if (!fs::exists(file))
    fail_input("{}: expected {} of {} there, found no such file; copy the folder {} with the image",
               file.string(), wanted.name, image.file.filename().string(), image.description.parts);
  return file;
}

std::unique_ptr<E57RecordReader> ExrSource::open_stored(std::size_t part) const {
  const E57Part& wanted = outline().parts.at(part);
  auto records =
      std::make_unique<ExrRecords>(wanted.points ? images_[*wanted.scan].file : part_file(part), salvage_);
  if (records->count() != stored_count(part))
    fail_input("{}: header: expected {} records of {}, found {}; copy or write the file again", name(),
               stored_count(part), wanted.name, records->count());
  records->open(table(part));
  return records;
}

std::vector<char> ExrSource::blob(std::size_t part) const {
  const fs::path file = part_file(part);
  const E57Part& wanted = outline().parts[part];
  const std::uint64_t length = wanted.length;
  std::vector<char> bytes;
  if (length == 0 && fs::file_size(file) == 0) return bytes;
  const InputFile input(file);
  if (input.size() != length)
    fail_input("{}: expected {} bytes, as the range image says, found {}; copy the folder again",
               file.string(), length, input.size());
  bytes.resize(length);
  input.read(0, bytes);
  const std::string& sums = images_[wanted.scan.value_or(0)].description.part_sums;
  const std::string_view expected = sum_at(sums, wanted.offset);
  if (!expected.empty() && checksum(bytes) != expected)
    fail_input(
        "{}: expected the bytes with checksum {}, as the range image says, found {}; it was changed or "
        "damaged: copy "
        "the folder again",
        file.string(), expected, checksum(bytes));
  return bytes;
}

fs::path parts_folder(const fs::path& exr) {
  return fs::path(exr).replace_extension(".parts");
}

std::string part_name(const E57Part& part) {
  std::string name = part.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  const char* extension = !part.blob                                            ? "exr"
                          : part.name == "jpegImage"                            ? "jpg"
                          : part.name == "pngImage" || part.name == "imageMask" ? "png"
                                                                                : "bin";
  return fmt::format("{}-{}.{}", name, part.offset, extension);
}

void write_exr_scan(const E57Source& source, std::size_t scan, const fs::path& file, const fs::path& folder,
                    const std::string& part_sums) {
  RecordsDescription description;
  const std::vector<E57Part>& parts = source.outline().parts;
  std::vector<TextEdit> cuts;
  std::size_t cut_bytes = 0;
  for (const TextRange range : source.outline().scans) {
    cuts.push_back({range, {}});
    description.cuts.push_back(range.begin - cut_bytes);
    cut_bytes += range.end - range.begin;
  }
  description.xml = edited(source.xml(), cuts);
  description.scan_xml = text_at(source.xml(), source.outline().scans.at(scan));
  description.scan = scan;
  if (std::ranges::any_of(parts, [&](const E57Part& part) { return !part.points; }))
    description.parts = folder.filename().string();
  description.part_sums = part_sums;
  description.attributes["source_file"] = fs::path(source.name()).filename().string();
  const E57Contents& contents = source.contents();
  if (!contents.coordinate_system.empty()) description.attributes["crs"] = contents.coordinate_system;
  const auto reader = source.open(source.points(scan));
  write_exr_records(file, contents.scans.at(scan), *reader, description);
}

std::string write_exr_parts(const E57Source& source, const fs::path& folder) {
  std::string sums;
  for (std::size_t part = 0; part < source.outline().parts.size(); ++part) {
    const E57Part& one = source.outline().parts[part];
    if (one.points) continue;
    const fs::path file = folder / part_name(one);
    if (one.blob) {
      const std::vector<char> bytes = source.blob(part);
      sums += fmt::format("{}{}:{}", sums.empty() ? "" : " ", one.offset, checksum(bytes));
      write_atomically(file, [&](const fs::path& temporary) {
        OutputFile out(temporary);
        out.write(bytes.data(), bytes.size());
        out.close();
      });
      continue;
    }
    E57Scan scan;
    scan.points = source.table(part);
    RecordsDescription description;
    description.scan_xml = text_at(source.xml(), one.element);
    write_exr_records(file, scan, *source.open(part), description);
  }
  return sums;
}

ScanEntry list_exr_records(const fs::path& file) {
  const ExrRecords records(file);
  const RecordLayout& layout = records.layout();
  ScanEntry entry;
  entry.name = file.stem().string();
  entry.samples = layout.samples;
  entry.unit = std::string("m");
  if (records.description().xml.empty()) {
    entry.problem = fmt::format(
        "{}: a table of an E57 file, no scan: convert the range image beside its folder", file.string());
    return entry;
  }
  const ExrSource source({file});
  const E57Scan& scan = source.contents().scans[0];
  if (layout.grid()) {
    entry.grid_rows = layout.grid_rows;
    entry.grid_cols = layout.cols;
  }
  entry.structure =
      fmt::format("range image with records of {}{}:", scan.name.empty() ? "a scan" : in_quotes(scan.name),
                  layout.grid() ? "" : ", a list");
  for (const E57Field& field : scan.points.fields) entry.structure += ' ' + describe_field(field);
  entry.crs = source.contents().coordinate_system;
  return entry;
}

Scan read_exr_records(const fs::path& file, const ReadOptions& options) {
  const ExrSource source({file}, options.salvage);
  const auto reader = source.open(source.points(0));
  return read_e57(file.string(), source.contents(), 0, *reader, options);
}

std::unique_ptr<ScanStream> stream_exr_records(const fs::path& file, const ScanEntry& entry) {
  const auto source = std::make_shared<const ExrSource>(std::vector{file}, entry.salvage);
  return E57Stream::open(file.string(), source->contents(), 0, source->open(source->points(0)), entry,
                         source);
}

}  // namespace hybrid::io
