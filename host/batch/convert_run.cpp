#include "batch/convert_run.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "batch/convert_records.hpp"
#include "core/error.hpp"
#include "core/log.hpp"
#include "io/read_scan.hpp"
#include "io/scan_writers.hpp"
#include "io/stream_scan.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Input {
  fs::path file;
  io::ScanEntry scan;
};
struct Output {
  fs::path file;
  std::vector<Input> scans;
};

std::vector<fs::path> inputs_of(const ConvertRequest& request) {
  std::vector<fs::path> files{request.in};
  files.insert(files.end(), request.more.begin(), request.more.end());
  return files;
}

void check_output(const fs::path& file, const ConvertRequest& request, bool is_folder = false) {
  std::error_code code;
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  if (!fs::is_directory(folder, code))
    fail(ErrorKind::usage, "{}: expected a folder {} to write into, found none; make it first", file.string(),
         folder.string());
  if (!fs::exists(file, code)) return;
  if (!is_folder && fs::is_directory(file, code))
    fail(ErrorKind::usage, "{}: expected the name of a file, found a folder; add a name with an extension",
         file.string());
  if (std::ranges::any_of(inputs_of(request),
                          [&](const fs::path& input) { return fs::equivalent(file, input, code); }))
    fail(ErrorKind::usage, "{}: is the input itself; choose another name", file.string());
  if (!request.force)
    fail(ErrorKind::usage, "{}: is there already; choose another name or add --force to replace it",
         file.string());
}

// What goes where, all names checked before anything is read or written.
std::vector<Output> plan(const ConvertRequest& request, const io::ScanWriter& writer) {
  std::vector<Input> scans;
  for (const fs::path& file : inputs_of(request)) {
    auto entries = io::list_scans(file, {.salvage = request.salvage, .exact = true});
    if (request.index) entries = {io::scan_at(file, entries, *request.index)};
    for (io::ScanEntry& entry : entries) scans.push_back({file, std::move(entry)});
  }
  std::vector<Output> outputs;
  if (writer.several || scans.size() == 1) {
    outputs.push_back({request.out, std::move(scans)});
  } else {
    for (const Input& input : scans)
      outputs.push_back(
          {request.out.parent_path() / fmt::format("{}-{}{}", request.out.stem().string(), input.scan.index,
                                                   request.out.extension().string()),
           {input}});
  }
  for (const Output& output : outputs) check_output(output.file, request);
  return outputs;
}

class Conversion {
 public:
  Conversion(const ConvertRequest& request, const io::ScanWriter& writer)
      : request_(request), writer_(writer) {
    for (const fs::path& file : inputs_of(request)) {
      ConvertRequest of_file = request;
      of_file.in = file;
      photographs_ += photographs_in(of_file);
    }
  }

  ConvertRun go() {
    ConvertRun run;
    Json written = Json::array();
    for (const Output& output : plan(request_, writer_)) {
      try {
        written.push_back(write(output));
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) throw;
      }
    }
    if (written.empty()) throw Error(last_failure_.value());
    run.summary = {{"input", request_.in.string()}, {"outputs", written}, {"failures", failures_}};
    for (const fs::path& file : request_.more) run.summary["more_inputs"].push_back(file.string());
    run.exit_code = failures_.empty() ? 0 : 3;
    return run;
  }

 private:
  // The scans of one output that can be read, one after the other; throws when that is none.
  Json write(const Output& output) {
    scans_ = Json::array();
    std::size_t at = 0;
    writer_.write(output.file, [&]() -> std::unique_ptr<io::ScanStream> {
      while (at < output.scans.size())
        if (auto scan = open(output.scans[at++])) return scan;
      if (scans_.empty()) throw Error(last_failure_.value());
      return nullptr;
    });
    return {{"file", output.file.string()},
            {"format", writer_.name},
            {"bytes", fs::file_size(output.file)},
            {"scans", scans_}};
  }

  std::unique_ptr<io::ScanStream> open(const Input& input) {
    const io::ScanEntry& entry = input.scan;
    try {
      auto scan = io::stream_scan(input.file, entry);
      tell(*scan);
      return scan;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      log::error("scan {}: {}", entry.name, error.what());
      failures_.push_back({{"scan", entry.name}, {"error", error.what()}});
      last_failure_ = error;
      return nullptr;
    }
  }

  void tell(const io::ScanStream& stream) {
    const Scan& scan = stream.head();
    auto losses = io::losses_of(writer_, stream);
    if (scans_.empty() && photographs_ > 0)
      losses.dropped.push_back(fmt::format("photographs ({})", photographs_));
    for (const auto& note : scan.notes) log::warning("scan {}: {}", scan.name, note);
    if (!losses.dropped.empty())
      log::warning("scan {}: dropped, {}: {}", scan.name,
                   request_.more.empty() ? fmt::format("{} cannot hold it", writer_.name)
                                         : fmt::format("{} of several files has none of it", writer_.name),
                   fmt::join(losses.dropped, ", "));
    for (const auto& change : losses.changed) log::warning("scan {}: {}", scan.name, change);
    scans_.push_back({{"name", scan.name},
                      {"samples", stream.count()},
                      {"dropped", losses.dropped},
                      {"changed", losses.changed},
                      {"notes", scan.notes}});
  }

  const ConvertRequest& request_;
  const io::ScanWriter& writer_;
  std::size_t photographs_ = 0;
  Json scans_ = Json::array(), failures_ = Json::array();
  std::optional<Error> last_failure_;
};

// In salvage: a description that cannot be copied as it is.
bool damaged_description(const ConvertRequest& request) {
  if (!request.salvage) return false;
  try {
    record_outputs(request);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    return true;
  }
  return false;
}

bool keeps_records(const ConvertRequest& request) {
  const io::ScanWriter& writer = io::writer_for(request.out);
  if (!request.more.empty() && request.index)
    fail(ErrorKind::usage, "--index: expected one input, which has that scan, found {}",
         1 + request.more.size());
  if (!request.more.empty() && !writer.several)
    fail(
        ErrorKind::usage,
        "{}: expected one input, as a file of {} holds one scan, found {}; convert each by itself, or choose "
        "an .e57",
        request.out.string(), writer.name, 1 + request.more.size());
  return converts_records(request);
}

// Of a conversion of records.
std::vector<fs::path> checked_outputs(const ConvertRequest& request) {
  const auto files = record_outputs(request);
  for (const fs::path& file : files) check_output(file, request, file.extension() == ".parts");
  return files;
}

}  // namespace

ConvertRun run_convert(const ConvertRequest& request) {
  io::writer_for(request.out);
  if (keeps_records(request)) {
    if (!damaged_description(request)) {
      checked_outputs(request);
      return convert_records(request);
    }
    log::warning("{}: its description is damaged: its samples are converted, not all that is stored",
                 request.in.string());
  }
  return Conversion(request, io::writer_for(request.out)).go();
}

DryRun try_convert(const ConvertRequest& request) {
  DryRun tried;
  if (keeps_records(request) && !damaged_description(request)) {
    for (const fs::path& file : checked_outputs(request))
      tried.lines.push_back(fmt::format("would write {}: records as stored", file.string()));
    return tried;
  }
  bool good = false;
  for (const Output& output : plan(request, io::writer_for(request.out))) {
    std::string line = fmt::format("would write {}:", output.file.string());
    for (const auto& [file, entry] : output.scans) {
      if (entry.problem.empty())
        line += fmt::format(" {} ({} samples)", entry.name, entry.samples);
      else
        tried.problems.push_back(
            fmt::format("{}: not {}: {}", output.file.string(), entry.name, entry.problem));
      good |= entry.problem.empty();
    }
    tried.lines.push_back(std::move(line));
  }
  if (!tried.problems.empty()) tried.exit_code = good ? 3 : exit_code(ErrorKind::input);
  return tried;
}

std::string text_of(const ConvertRun& run) {
  std::string text;
  for (const auto& output : run.summary["outputs"]) {
    std::uint64_t samples = 0;
    for (const auto& scan : output["scans"]) samples += scan["samples"].get<std::uint64_t>();
    text += fmt::format("{}: {} scan{}, {} samples, {} bytes\n", output["file"].get<std::string>(),
                        output["scans"].size(), output["scans"].size() == 1 ? "" : "s", samples,
                        output["bytes"].get<std::uint64_t>());
  }
  for (const auto& failure : run.summary["failures"])
    text += fmt::format("failed: scan {}: {}\n", failure["scan"].get<std::string>(),
                        failure["error"].get<std::string>());
  return text;
}

}  // namespace hybrid::batch
