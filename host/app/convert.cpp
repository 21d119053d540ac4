#include <iostream>

#include "app/commands.hpp"
#include "batch/convert_run.hpp"
#include "core/json_text.hpp"
#include "io/read_scan.hpp"

namespace hybrid::app {

namespace {
constexpr int kMostFiles = 10'000;
}

void add_convert(CLI::App& program, int& exit_code) {
  auto* command =
      program.add_subcommand("convert", "a scan file into another format, chosen by its extension");
  auto common = std::make_shared<CommonOptions>();
  auto request = std::make_shared<batch::ConvertRequest>();
  auto files = std::make_shared<std::vector<std::filesystem::path>>();
  command
      ->add_option("files", *files,
                   "IN... and OUT: scan files (" + io::scan_extensions() +
                       ") and the file to write (.e57, .exr, .ptx, .pts, .xyz, .ply, .pcd or .las); of "
                       "several files the "
                       "scans go into one .e57 or .ptx")
      ->required()
      ->expected(2, kMostFiles);
  command->add_option("--index", request->index, "this scan of the file alone, from 0");
  add_salvage_option(*command, request->salvage);
  add_common_options(*command, *common);
  command->get_option("--force")->description("replace files that are there");
  command->callback([=, &exit_code] {
    apply(*common);
    request->force = common->force;
    request->in = files->front();
    request->out = files->back();
    request->more.assign(files->begin() + 1, files->end() - 1);
    if (common->dry_run) {
      const auto tried = batch::try_convert(*request);
      print_dry_run(*common, tried);
      exit_code = tried.exit_code;
      return;
    }
    const auto run = batch::run_convert(*request);
    if (common->json)
      std::cout << json_text(run.summary) << "\n";
    else
      std::cout << batch::text_of(run);
    exit_code = run.exit_code;
  });
}

}  // namespace hybrid::app
