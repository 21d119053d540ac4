#include "archive/manifest.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "../e2e/program.hpp"
#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::archive {
namespace {

// Scenes of three scans, then the report: a unit's lines are as long as those of a real plan.
Manifest synthetic(std::size_t scenes) {
  Manifest manifest;
  manifest.archive = "/archive";
  manifest.build = {"planes", "all", "Release", "cpu"};
  manifest.problems = {{"bad/scene.toml", "line 3: \"units\":[\n and other text"}};
  const auto add = [&](Unit unit, UnitKind kind) {
    unit.kind = kind;
    unit.index = unit.number = manifest.units.size();
    unit.key = fmt::format("{:032x}", unit.index + 1);
    unit.estimate_s = 0.1 * static_cast<double>(unit.index);
    unit.estimate_bytes = 1'000'000'007;
    unit.from = nlohmann::json{{"kind", "planes"}, {"options", std::string(2000, 'o')}}.dump();
    for (int i = 0; i < 3; ++i)
      unit.inputs.push_back(
          {fmt::format("/archive/scene-{}/{}.e57", unit.index, i), 1234, 5678, std::string(32, 'a'), ""});
    manifest.units.push_back(std::move(unit));
  };
  for (std::size_t i = 0; i < 3 * scenes; ++i) {
    Unit unit;
    unit.id = fmt::format("planes scene-{} {}", i / 3, i % 3);
    unit.file = fmt::format("/archive/scene-{}/{}.e57", i / 3, i % 3);
    unit.scan_id = std::to_string(i % 3);
    unit.entry = i % 3;
    add(std::move(unit), UnitKind::planes);
  }
  for (std::size_t i = 0; i < scenes; ++i) {
    Unit unit;
    unit.id = unit.result = fmt::format("scene scene-{}", i);
    unit.scene = fmt::format("/archive/scene-{}/scene.toml", i);
    unit.needs = {3 * i, 3 * i + 1, 3 * i + 2};
    unit.settings.assignments = {"planes.square=5"};
    unit.settings.seed = 7;
    add(std::move(unit), UnitKind::scene);
  }
  Unit report;
  report.id = report.result = "report";
  for (std::size_t i = 0; i < 4 * scenes; ++i) report.needs.push_back(i);
  add(std::move(report), UnitKind::report);
  return manifest;
}

// Bytes that this process has asked the system for, 0 where it does not count.
std::uint64_t bytes_read() {
  std::ifstream file("/proc/self/io");
  std::string word;
  std::uint64_t value = 0;
  while (file >> word >> value)
    if (word == "rchar:") return value;
  return 0;
}

TEST(ArchiveManifest, its_text_is_one_json_document_and_comes_back_whole) {
  const e2e::Scratch folder;
  for (const std::size_t scenes : {0u, 1u, 3u}) {
    auto manifest = synthetic(scenes);
    if (scenes == 0) manifest.units.clear();
    const std::string text = to_text(manifest);
    const auto json = nlohmann::json::parse(text);
    ASSERT_EQ(json["units"].size(), manifest.units.size());
    io::write_text(folder.path() / "m.json", text);
    EXPECT_EQ(to_text(read_manifest(folder.path() / "m.json")), text);
    EXPECT_EQ(count_units(folder.path() / "m.json"), manifest.units.size());
    EXPECT_EQ(read_manifest_head(folder.path() / "m.json").problems.front().what,
              manifest.problems.front().what);
  }
}

TEST(ArchiveManifest, a_unit_comes_with_what_it_needs) {
  const e2e::Scratch folder;
  const auto file = folder.path() / "m.json";
  const auto whole = synthetic(5);
  io::write_text(file, to_text(whole));
  const auto part = read_units(file, {16});  // the scene of scans 3 to 5
  ASSERT_EQ(part.units.size(), 4u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(part.units[i].index, i);
    EXPECT_EQ(part.units[i].number, 3 + i);
    EXPECT_EQ(part.units[i].key, whole.units[3 + i].key);
    EXPECT_EQ(part.units[i].scan_id, whole.units[3 + i].scan_id);
    EXPECT_TRUE(part.units[i].inputs.empty() && part.units[i].from.empty());
  }
  const Unit& scene = part.units[3];
  EXPECT_EQ(scene.number, 16u);
  EXPECT_EQ(scene.needs, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(scene.from, whole.units[16].from);
  EXPECT_EQ(scene.inputs.size(), 3u);
  EXPECT_EQ(scene.settings.seed, 7);
  EXPECT_EQ(read_units(file, {20}).units.size(), whole.units.size());  // the report needs all
  EXPECT_EQ(read_units(file, {16, 0, 16}).units.size(), 5u);
  EXPECT_THROW(read_units(file, {21}), Error);
}

TEST(ArchiveManifest, a_process_reads_only_its_unit) {
  const e2e::Scratch folder;
  const auto file = folder.path() / "m.json";
  io::write_text(file, to_text(synthetic(2000)));
  const auto size = std::filesystem::file_size(file);
  ASSERT_GT(size, 20'000'000u);
  const std::uint64_t before = bytes_read();
  if (before == 0) GTEST_SKIP() << "the system does not count what a process reads";
  EXPECT_EQ(count_units(file), 8001u);
  EXPECT_EQ(read_units(file, {7999}).units.size(), 4u);
  EXPECT_LT(bytes_read() - before, 40'000u) << "of " << size;
}

TEST(ArchiveManifest, a_damaged_one_is_an_error_that_says_what_to_do) {
  const e2e::Scratch folder;
  const auto file = folder.path() / "m.json";
  const std::string text = to_text(synthetic(2));
  const auto message = [&](const std::string& damaged) -> std::string {
    io::write_text(file, damaged);
    try {
      read_manifest(file);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(text), "");
  for (std::size_t cut = 1; cut < text.size(); cut += 97)
    EXPECT_NE(message(text.substr(0, cut)).find("make the plan again"), std::string::npos) << cut;
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  EXPECT_NE(message(replaced("\"number\":3", "\"number\":9")).find("unit 3"), std::string::npos);
  EXPECT_NE(message(replaced("\"needs\":[0,", "\"needs\":[8,")).find("needs a later one"), std::string::npos);
  EXPECT_NE(message(replaced("manifest 2", "manifest 1")).find("expected"), std::string::npos);
  EXPECT_NE(message(replaced("\"offsets\":[\n\"0", "\"offsets\":[\n\"f")), "");
  EXPECT_NE(message(replaced("\"count\":\"0", "\"count\":\"f")), "");
}

}  // namespace
}  // namespace hybrid::archive
