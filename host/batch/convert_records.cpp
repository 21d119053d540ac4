#include "batch/convert_records.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/las/las_records.hpp"
#include "io/read_scan.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string extension_of(const fs::path& file) {
  return io::lower_case(file.extension().string());
}

bool is_e57(const fs::path& file) {
  return extension_of(file) == ".e57";
}

bool is_las(const fs::path& file) {
  return extension_of(file) == ".las";
}

bool has_parts(const io::E57Source& source) {
  return std::ranges::any_of(source.outline().parts, [](const io::E57Part& part) { return !part.points; });
}

std::string number_of(std::size_t index) {
  return fmt::format("-{}", index);
}

class RecordsConversion {
 public:
  explicit RecordsConversion(const ConvertRequest& request) : request_(request) {
    if (is_las(request.in) && request.index)
      io::scan_at(request.in, io::list_scans(request.in), *request.index);
    if (!is_e57(request.in)) return;
    const auto entries = io::list_scans(request.in, {.salvage = request.salvage});
    for (const auto& entry : entries) wanted_.insert(entry.index);
    several_ = wanted_.size() > 1;
    if (request.index) {
      io::scan_at(request.in, entries, *request.index);
      wanted_ = {*request.index};
      several_ = false;
    }
  }

  std::unique_ptr<io::E57Source> open(const std::set<std::size_t>& scans) const {
    if (is_e57(request_.in))
      return std::make_unique<io::E57FileSource>(request_.in, scans,
                                                 io::E57Options{.salvage = request_.salvage});
    if (is_las(request_.in)) return std::make_unique<io::LasAsE57>(request_.in);
    std::vector<fs::path> files{request_.in};
    files.insert(files.end(), request_.more.begin(), request_.more.end());
    return std::make_unique<io::ExrSource>(files, request_.salvage);
  }
  const std::set<std::size_t>& wanted() const { return wanted_; }

  // Of a scan in the input.
  fs::path output_of(std::size_t index) const {
    if (is_e57(request_.out) || !several_) return request_.out;
    return request_.out.parent_path() /
           (request_.out.stem().string() + number_of(index) + request_.out.extension().string());
  }

  // Of an E57 file in salvage: whether its description can be copied, whatever the points are.
  void check_description() const { open({}); }

  // Reads everything that would be copied. The scans that cannot be read.
  std::map<std::size_t, Error> probe() const {
    std::map<std::size_t, Error> bad;
    for (const std::size_t index : wanted_) {
      try {
        const auto source = open({index});
        read_all(*source);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) throw;
        bad.emplace(index, error);
      }
    }
    return bad;
  }

  ConvertRun go() {
    auto scans = wanted_;
    ConvertRun run;
    Json written = Json::array();
    try {
      written = write(*open(scans), scans);
    } catch (const Error& error) {
      // One of several: the others go on without it.
      if (error.kind() != ErrorKind::input || !is_e57(request_.in) || scans.size() < 2) throw;
      const auto bad = probe();
      if (bad.empty() || bad.size() == scans.size()) throw;
      for (const auto& [index, problem] : bad) {
        const std::string name = request_.in.stem().string() + number_of(index);
        log::error("scan {}: {}", name, problem.what());
        failures_.push_back({{"scan", name}, {"error", problem.what()}});
        scans.erase(index);
      }
      written = write(*open(scans), scans);
    }
    run.summary = {{"input", request_.in.string()}, {"outputs", written}, {"failures", failures_}};
    run.exit_code = failures_.empty() ? 0 : 3;
    return run;
  }

 private:
  static void read_all(const io::E57Source& source) {
    for (std::size_t part = 0; part < source.outline().parts.size(); ++part) {
      if (source.outline().parts[part].blob) {
        source.blob(part);
        continue;
      }
      const auto reader = source.open(part);
      reader->read(io::all_fields(source.table(part)), 0, reader->count(), [](const io::E57Records&) {});
    }
  }

  Json write(const io::E57Source& source, const std::set<std::size_t>& scans) {
    if (!source.dropped().empty())
      log::warning("{}: dropped: {}", request_.in.filename().string(), fmt::join(source.dropped(), ", "));
    for (std::size_t k = 0; k < source.contents().scans.size(); ++k)
      for (const auto& note : source.notes(k)) log::warning("scan {}: {}", name_of(source, k), note);
    Json outputs = Json::array();
    if (is_e57(request_.out)) {
      io::copy_e57(source, request_.out);
      Json all = Json::array();
      for (std::size_t k = 0; k < source.contents().scans.size(); ++k) all.push_back(scan_json(source, k));
      outputs.push_back(output_json(request_.out, "E57", std::move(all)));
    } else {
      const fs::path folder = io::parts_folder(request_.out);
      const std::string sums = has_parts(source) ? io::write_exr_parts(source, folder) : std::string();
      auto index = scans.begin();
      for (std::size_t k = 0; k < source.contents().scans.size(); ++k) {
        const fs::path file = output_of(scans.empty() ? 0 : *index++);
        io::write_exr_scan(source, k, file, folder, sums);
        outputs.push_back(output_json(file, "EXR", Json::array({scan_json(source, k)})));
        if (has_parts(source)) outputs.back()["parts"] = folder.string();
      }
    }
    return outputs;
  }

  static Json output_json(const fs::path& file, const char* format, Json scans) {
    return {{"file", file.string()},
            {"format", format},
            {"bytes", fs::file_size(file)},
            {"scans", std::move(scans)}};
  }

  static std::string name_of(const io::E57Source& source, std::size_t k) {
    const std::string& name = source.contents().scans[k].name;
    return !name.empty() ? name : fs::path(source.name()).stem().string() + number_of(k);
  }

  static Json scan_json(const io::E57Source& source, std::size_t k) {
    return {{"name", name_of(source, k)},  {"samples", source.contents().scans[k].points.count},
            {"dropped", source.dropped()}, {"changed", Json::array()},
            {"notes", source.notes(k)},    {"records", "as stored"}};
  }

  const ConvertRequest& request_;
  std::set<std::size_t> wanted_;  // of an E57 file
  bool several_ = false;
  Json failures_ = Json::array();
};

}  // namespace

bool converts_records(const ConvertRequest& request) {
  const std::string out = extension_of(request.out);
  if (out != ".e57" && out != ".exr") return false;
  const auto is_image_with_records = [](const fs::path& file) {
    return extension_of(file) == ".exr" && fs::is_regular_file(file) && io::holds_exr_records(file);
  };
  if (request.more.empty() && is_e57(request.in)) return true;
  if (request.more.empty() && is_las(request.in)) return !request.salvage;  // which reads samples
  return is_image_with_records(request.in) && std::ranges::all_of(request.more, is_image_with_records);
}

std::size_t photographs_in(const ConvertRequest& request) {
  if (is_e57(request.in))
    return io::E57File(request.in, {.salvage = request.salvage}).contents().images.size();
  if (extension_of(request.in) != ".exr" || !fs::is_regular_file(request.in) ||
      !io::holds_exr_records(request.in))
    return 0;
  return io::ExrSource({request.in}).contents().images.size();
}

std::vector<fs::path> record_outputs(const ConvertRequest& request) {
  const RecordsConversion conversion(request);
  if (request.salvage && is_e57(request.in)) conversion.check_description();
  std::vector<fs::path> files;
  for (const std::size_t index : conversion.wanted()) files.push_back(conversion.output_of(index));
  if (is_e57(request.out) || files.empty()) files = {request.out};
  if (!is_e57(request.out) && has_parts(*conversion.open(conversion.wanted())))
    files.push_back(io::parts_folder(request.out));
  return files;
}

ConvertRun convert_records(const ConvertRequest& request) {
  return RecordsConversion(request).go();
}

}  // namespace hybrid::batch
