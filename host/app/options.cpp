#include <iostream>

#include "app/commands.hpp"
#include "batch/option_text.hpp"
#include "core/json_text.hpp"

namespace hybrid::app {

void add_options(CLI::App& program, int&) {
  auto* command = program.add_subcommand(
      "options",
      "keys of [planes], [register], [edit], [render] and [export]: defaults, ranges, what they do");
  auto common = std::make_shared<CommonOptions>();
  auto sections = std::make_shared<std::vector<std::string>>();
  add_common_options(*command, *common);
  command->add_option("section", *sections, "of these alone: planes, register, edit, render, export")
      ->check(CLI::IsMember(batch::option_sections()));
  command->callback([=] {
    apply(*common);
    const auto notes = batch::option_notes(*sections);
    if (common->json)
      std::cout << json_text(batch::option_json(notes)) << "\n";
    else
      std::cout << batch::option_text(notes);
  });
}

}  // namespace hybrid::app
