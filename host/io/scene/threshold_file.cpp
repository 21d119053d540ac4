#include "io/scene/threshold_file.hpp"

#include "io/scene/scene_table.hpp"

namespace hybrid::io {
namespace {

double limit(const SceneTable& table, const char* key) {
  const double value = table.number(key).value_or(0);
  if (value < 0) table.fail_key(key, "expected 0 or more, found {}", value);
  return value;
}

Threshold read_figure(const SceneTable& table) {
  Threshold figure;
  figure.name = table.required_text("name");
  const std::string worse = table.choice("worse", {"higher", "lower", "never"}, "higher");
  figure.worse = worse == "higher"  ? Threshold::Worse::higher
                 : worse == "lower" ? Threshold::Worse::lower
                                    : Threshold::Worse::never;
  figure.absolute = limit(table, "absolute");
  figure.relative = limit(table, "relative");
  return figure;
}

}  // namespace

ThresholdFile read_threshold_file(const std::filesystem::path& file) {
  const std::string text = read_plain_text(file);
  try {
    const toml::table document = toml::parse(text, file.string());
    const SceneTable root(file, "", document, {"defaults", "figure"});
    ThresholdFile thresholds;
    thresholds.defaults = root.flag("defaults", true);
    for (const SceneTable& table : root.tables("figure", {"name", "worse", "absolute", "relative"}))
      thresholds.figures.push_back(read_figure(table));
    return thresholds;
  } catch (const toml::parse_error& error) {
    fail_input("{}:{}:{}: no valid TOML: {}", file.string(), error.source().begin.line,
               error.source().begin.column, error.description());
  }
}

}  // namespace hybrid::io
