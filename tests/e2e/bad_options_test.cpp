// Options, exit codes and where output goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bad_mini_scene.hpp"
#include "bad_output_check.hpp"
#include "io/output.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

struct Usage {
  const char* name;
  std::string arguments;
  int code;
  std::vector<std::string> message;
};

void PrintTo(const Usage& row, std::ostream* out) {
  *out << row.name;
}

class WrongOption : public ::testing::TestWithParam<Usage> {};

// SCENE stands for the mini scene, OUT for a folder that must not come into being.
std::vector<Usage> wrong_options() {
  return {
      {"nothing", "", 2, {"subcommand", "--help"}},
      {"unknown_command", "fly", 2, {"unknown command \"fly\"", "run", "devices", "--help"}},
      {"mistyped_command", "plane", 2, {"did you mean \"planes\"?"}},
      {"unknown_option", "run SCENE --out OUT --fast", 2, {"--fast", "--help"}},
      {"no_scene", "run --out OUT", 2, {"scene is required"}},
      {"no_out", "run SCENE", 2, {"--out is required"}},
      {"threads_negative", "run SCENE --out OUT --threads -1", 2, {"--threads -1", "0 (all cores)"}},
      {"threads_text", "run SCENE --out OUT --threads abc", 2, {"--threads", "abc"}},
      {"threads_huge", "run SCENE --out OUT --threads 99999999999", 2, {"--threads", "99999999999"}},
      {"threads_many", "run SCENE --out OUT --threads 1000000", 2, {"--threads 1000000", "4096"}},
      {"seed_text", "run SCENE --out OUT --seed x", 2, {"--seed", "x"}},
      {"tile_small", "run SCENE --out OUT --tile 1", 2, {"--tile", "16"}},
      {"log_level",
       "run SCENE --out OUT --log-level loud",
       2,
       {"loud", "debug, info, warning, error or off"}},
      {"device_99", "run SCENE --out OUT --device 99", 5, {"--device 99", "no such device", "[0]"}},
      {"device_text", "run SCENE --out OUT --device abacus", 5, {"--device abacus", "no such device", "[0]"}},
      {"options_of_no_section", "options fly", 2, {"fly", "planes", "render"}},
      {"set_edit_list", "run SCENE --out OUT --set edit.holes=3", 2, {"--set edit.holes=3", "scene file"}},
      {"export_formats",
       "run SCENE --out OUT --only planes,export --set export.formats=gltf",
       2,
       {"export.formats=gltf", "colmap, e57, glb", "found \"gltf\""}},
      {"only_unknown", "run SCENE --out OUT --only plane", 2, {"--only plane", "planes, register"}},
      {"only_empty", "run SCENE --out OUT --only ''", 2, {"--only", "planes, register"}},
      {"square", "planes SCENE --out OUT --square 99", 2, {"--square 99", "3 to 16"}},
      {"view", "render SCENE --out OUT --view side", 4, {"--view side", "no view or path of that name"}},
      {"info_nothing", "info /nowhere/scan.ply", 4, {"/nowhere/scan.ply", "no such file"}},
      {"planes_missing_dry", "planes /nowhere/scan.ply --out OUT --dry-run", 4, {"/nowhere/scan.ply"}},
  };
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  if (const auto at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

Outcome hybrid(const std::string& arguments, const fs::path& out, const std::string& before = "") {
  return run(
      before + "hybrid " +
      replaced(replaced(arguments, "SCENE", (mini_scene() / "scene.toml").string()), "OUT", out.string()));
}

}  // namespace

TEST_P(WrongOption, is_told_and_nothing_is_written) {
  const Scratch scratch;
  const auto outcome = hybrid(GetParam().arguments, scratch / "out");
  expect_failure(outcome, GetParam().code, GetParam().message);
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

INSTANTIATE_TEST_SUITE_P(Options, WrongOption, ::testing::ValuesIn(wrong_options()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(Options, version_and_help_go_to_stdout) {
  const auto version = run("hybrid --version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(version.out.starts_with("hybrid 0.")) << version.out;
  EXPECT_EQ(version.err, "");
  for (const char* command : {"", "run", "planes", "register", "render", "info", "devices"}) {
    const auto help = run(std::string("hybrid ") + command + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("--help"), std::string::npos) << command;
    EXPECT_EQ(help.err, "");
  }
}

TEST(Options, stdout_that_cannot_be_written_is_an_error) {
  for (const char* command : {"devices", "--version", "run --help"}) {
    const auto outcome = run(std::string("hybrid ") + command + " > /dev/full");
    expect_failure(outcome, 1, {"stdout"});
  }
}

TEST(Options, dry_run_writes_nothing_and_names_every_input) {
  const Scratch scratch;
  const auto outcome = hybrid("run SCENE --out OUT --dry-run", scratch / "out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* file : {"s.ply", "proxy.obj", "0.png", "1.png", "planes, register, render, report"})
    EXPECT_NE(outcome.out.find(file), std::string::npos) << file << "\n" << outcome.out;
  EXPECT_FALSE(fs::exists(scratch / "out"));
  const auto planes =
      hybrid("planes " + (mini_scene() / "s.ply").string() + " --out OUT --dry-run", scratch / "out");
  EXPECT_EQ(planes.exit_code, 0) << planes.err;
  EXPECT_NE(planes.out.find("s.ply"), std::string::npos);
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

// Of a scene all problems at once, each as the run would tell it.
TEST(Options, dry_run_tells_what_would_fail) {
  const Scratch scratch;
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  io::write_text(scratch / "scene/scene.toml",
                 replaced(mini_scene_text(), "[model]",
                          "[[scan]]\nid = \"none\"\nfile = \"s.ply\"\nindex = 3\n[model]"));
  const std::string command = "hybrid run " + (scratch / "scene/scene.toml").string() + " --quiet --out " +
                              (scratch / "out").string() + " --dry-run";
  expect_failure(run(command), 3, {"scan none", "index 3"});
  fs::copy_file(mini_result() / "views/front.png", scratch / "scene/images/1.png",
                fs::copy_options::overwrite_existing);
  const auto both = run(command + " --json");
  expect_failure(both, 4,
                 {"scan none", "index 3", "1.png: expected the camera's 64 x 48 pixels, found 32 x 24"});
  EXPECT_EQ(nlohmann::json::parse(both.out).at("problems").size(), 2u);
  EXPECT_EQ(run(command + " --only planes").exit_code, 3) << "nothing is drawn of photographs";
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

TEST(Options, dry_run_with_json_is_one_document) {
  const Scratch scratch;
  const std::string scan = (mini_scene() / "s.ply").string();
  const std::vector<std::string> commands = {"run SCENE --out OUT", "planes " + scan + " --out OUT",
                                             "convert " + scan + " OUT.las"};
  for (const std::string& command : commands) {
    const auto outcome = hybrid(command + " --dry-run --json", scratch / "out");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_FALSE(nlohmann::json::parse(outcome.out).at("dry_run").empty()) << command;
  }
}

// Lists end with their commas: what follows is the scene or the scan.
TEST(Options, a_list_does_not_take_what_follows) {
  const Scratch scratch;
  const std::string scan = (mini_scene() / "s.ply").string();
  EXPECT_EQ(hybrid("run --only planes,register SCENE --out OUT --dry-run", scratch / "out").exit_code, 0);
  EXPECT_EQ(hybrid("planes --scanner 0,0,0.5 " + scan + " --out OUT --dry-run", scratch / "out").exit_code,
            0);
  for (const char* place : {"0,0", "0,0,0,0", "0;0;0", "0,0,nan", ""})
    expect_failure(
        hybrid(std::string("planes ") + scan + " --out OUT --scanner '" + place + "'", scratch / "out"), 2,
        {"--scanner"});
}

TEST(Options, quiet_leaves_stderr_empty_and_the_log_level_rules_progress) {
  const Scratch scratch;
  EXPECT_EQ(hybrid("run SCENE --out OUT --only planes --quiet", scratch / "a").err, "");
  EXPECT_EQ(hybrid("run SCENE --out OUT --only planes --log-level warning", scratch / "b").err, "");
  const auto told = hybrid("run SCENE --out OUT --only planes", scratch / "c");
  EXPECT_NE(told.err.find("[1/8] scene mini: read"), std::string::npos) << told.err;
  EXPECT_NE(told.err.find("[8/8] scan s: write"), std::string::npos) << told.err;
  EXPECT_EQ(hybrid("run /nowhere.toml --out OUT --log-level off", scratch / "d").err, "");
  EXPECT_NE(hybrid("run /nowhere.toml --out OUT --quiet", scratch / "d").err, "");
}

TEST(Options, one_json_document_on_stdout) {
  const Scratch scratch;
  const auto outcome = hybrid("run SCENE --out OUT --only planes --json", scratch / "out");
  EXPECT_EQ(nlohmann::json::parse(outcome.out),
            nlohmann::json::parse(io::read_text(scratch / "out/summary.json")));
  EXPECT_EQ(hybrid("run /nowhere.toml --out OUT --json", scratch / "d").out, "");
}

// On a terminal progress rewrites its line and levels have colours; NO_COLOR and dumb terminals get neither.
TEST(Options, escapes_only_on_a_terminal_that_wants_them) {
  if (run("script -qec true /dev/null").exit_code != 0) GTEST_SKIP() << "no program `script`";
  const Scratch scratch;
  const std::string command =
      "script -qec 'hybrid run " + (mini_scene() / "scene.toml").string() + " --only planes --out ";
  const auto on_terminal = [&](const std::string& environment, const std::string& out) {
    return run(environment + " " + command + (scratch / out).string() + "' /dev/null").out;
  };
  EXPECT_NE(on_terminal("TERM=xterm NO_COLOR=", "a").find("\033["), std::string::npos);
  for (const char* environment : {"TERM=xterm NO_COLOR=1", "TERM=dumb NO_COLOR="}) {
    const std::string text = on_terminal(environment, "b");
    EXPECT_EQ(text.find('\033'), std::string::npos) << environment;
    EXPECT_NE(text.find("[8/8] scan s: write"), std::string::npos) << text;
  }
}

// What --only gives is what the whole run gives: nothing is taken from the folder, only less is written.
TEST(Options, only_writes_the_stages_named) {
  const auto files = [](const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder).string());
    std::sort(names.begin(), names.end());
    return names;
  };
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected = {
      {"run SCENE --only register", {"scans/s/pose.json", "scans/s/residuals.png"}},
      {"register SCENE", {"scans/s/pose.json", "scans/s/residuals.png"}},
      {"render SCENE --view front", {"views/front.exr", "views/front.png"}},
      {"run SCENE --only planes",
       {"scans/s/classes.png", "scans/s/detail.ply", "scans/s/intersections.obj", "scans/s/intersections.png",
        "scans/s/labels.exr", "scans/s/planes.json", "scans/s/planes/0001.png", "scans/s/planes/0002.png",
        "scans/s/planes/0003.png", "scans/s/planes/0004.png", "scans/s/planes/0005.png",
        "scans/s/planes/0006.png", "scans/s/planes/index.json", "scans/s/range.exr", "scans/s/range.png"}},
  };
  for (auto [command, names] : expected) {
    const Scratch scratch;
    const auto outcome = hybrid(command + " --quiet --out OUT", scratch / "out");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    names.insert(names.end(), {"summary.json", "timing.json"});
    std::sort(names.begin(), names.end());
    EXPECT_EQ(files(scratch / "out"), names) << command;
    for (const auto& name : names)  // range.exr holds the pose when there is one, detail.ply what it explains
      if (name.ends_with(".png") || name.starts_with("views/") || name.ends_with("pose.json")) {
        EXPECT_EQ(io::fingerprint(scratch / "out" / name).xxh3, io::fingerprint(mini_result() / name).xxh3)
            << name;
      }
  }
  const Scratch scratch;  // the report's page shows the others' files
  EXPECT_EQ(hybrid("run SCENE --only report --quiet --out OUT", scratch / "out").exit_code, 0);
  EXPECT_EQ(content_list(scratch / "out"), content_list(mini_result()));
}

TEST(Options, planes_has_the_same_timing_file_as_a_scene) {
  const Scratch scratch;
  EXPECT_EQ(
      hybrid("planes " + (mini_scene() / "s.ply").string() + " --quiet --out OUT", scratch / "out").exit_code,
      0);
  const auto planes = nlohmann::json::parse(io::read_text(scratch / "out/timing.json"));
  const auto scene = nlohmann::json::parse(io::read_text(mini_result() / "timing.json"));
  for (const auto& timing : {planes, scene}) {
    for (const char* key : {"host", "device", "threads", "out", "seconds_by_stage", "kernels"})
      EXPECT_TRUE(timing.contains(key)) << key;
    for (const auto& file : timing["inputs"]) {
      EXPECT_TRUE(fs::path(file.get<std::string>()).is_absolute()) << file;
      EXPECT_TRUE(fs::exists(file.get<std::string>())) << file;
    }
  }
  EXPECT_EQ(planes["inputs"].size(), 1u);
  EXPECT_EQ(planes["out"], (scratch / "out").string());
  EXPECT_EQ(scene["inputs"].size(), 5u);  // scene file, proxy, scan, two photographs
}

// A part of a run that failed is run again by what the user typed.
TEST(RunAgain, is_the_command_that_was_given) {
  const Scratch scratch;
  std::string text = mini_scene_text();
  text.resize(text.find("[model]"));
  fs::copy(mini_scene(), scratch / "a scene", fs::copy_options::recursive);
  io::write_text(scratch / "a scene/scene.toml", text + "[[scan]]\nid = \"t\"\nfile = \"t.ply\"\n");
  const std::string command = "hybrid register '" + (scratch / "a scene/scene.toml").string() + "' --out " +
                              (scratch / "out").string() + " --quiet --salvage --tile 256 --seed 3";
  const auto outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.out.find("run it again: " + command + "\n"), std::string::npos) << outcome.out;
}

// What `hybrid options` prints may stand in a scene file, and then changes nothing.
TEST(Options, are_listed_as_a_scene_file_has_them) {
  const Scratch scratch;
  const auto all = run("hybrid options"), export_alone = run("hybrid options export --json");
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_TRUE(all.out.starts_with("[planes]\n")) << all.out;
  EXPECT_NE(all.out.find("\nblend = \"linear\"\n"), std::string::npos);
  fs::copy(mini_scene(), scratch / "scene", fs::copy_options::recursive);
  std::string text = mini_scene_text();
  for (const char* section : {"[planes]", "[register]", "[edit]", "[render]", "[export]"})
    ASSERT_EQ(text.find(section), std::string::npos) << section;
  io::write_text(scratch / "scene/scene.toml", text + "\n" + all.out);
  const auto tried = run("hybrid run '" + (scratch / "scene/scene.toml").string() + "' --out " +
                         (scratch / "out").string() + " --dry-run");
  EXPECT_EQ(tried.exit_code, 0) << tried.err;
  const auto list = nlohmann::json::parse(export_alone.out);
  EXPECT_EQ(list.size(), 8u);
  for (const auto& one : list) EXPECT_EQ(one["section"], "export");
}

}  // namespace hybrid::e2e
