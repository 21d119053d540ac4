#include "batch/option_text.hpp"

#include <fmt/ranges.h>

namespace hybrid::batch {
namespace {

std::string range_in_words(const OptionNote& note) {
  const std::string unit = note.unit.empty() ? "" : " " + note.unit;
  return fmt::format("{} to {}{}: ", note.least, note.most, unit);
}

std::string takes_in_words(const OptionNote& note) {
  if (!note.choices.empty()) return fmt::format("\"{}\": ", fmt::join(note.choices, "\" | \""));
  return note.is_number ? range_in_words(note) : "";
}

}  // namespace

std::string option_text(const std::vector<OptionNote>& notes) {
  std::string text, section;
  for (const OptionNote& note : notes) {
    if (note.section != section) text += fmt::format("{}[{}]\n", section.empty() ? "" : "\n", note.section);
    section = note.section;
    text += fmt::format("# {}{}\n", takes_in_words(note), note.help);
    text += note.value.is_null() ? fmt::format("# {} =\n", note.key)
                                 : fmt::format("{} = {}\n", note.key, note.value.dump());
  }
  return text;
}

nlohmann::ordered_json option_json(const std::vector<OptionNote>& notes) {
  auto list = nlohmann::ordered_json::array();
  for (const OptionNote& note : notes) {
    nlohmann::ordered_json one = {{"section", note.section}, {"key", note.key}, {"default", note.value}};
    if (!note.unit.empty()) one["unit"] = note.unit;
    if (note.is_number) one.update({{"least", note.least}, {"most", note.most}});
    if (!note.choices.empty()) one["choices"] = note.choices;
    one["help"] = note.help;
    list.push_back(one);
  }
  return list;
}

}  // namespace hybrid::batch
