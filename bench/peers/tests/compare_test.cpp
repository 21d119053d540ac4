// hybrid-compare from its command line to its files, with small scripts in place of our programs and of those
// under HYBRID_PEERS_DIR.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "compare/process.hpp"

namespace hybrid::compare {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSynth = R"(
while [ $# -gt 0 ]; do case $1 in --out) out=$2; shift;; --megapixels) size=$2; shift;; esac; shift; done
if [ "$size" = 5 ]; then echo "the disk has 3 MB free" >&2; exit 75; fi
mkdir -p $out/scans; touch $out/scans/west.ply $out/scene.toml
)";
constexpr const char* kHybrid = R"(
if [ "$1" = devices ]; then echo '[{"name": "fake device", "driver": "7.1"}]'; exit; fi
if [ ! -e "$2" ]; then echo "$2: no such file" >&2; exit 4; fi
while [ $# -gt 0 ]; do case $1 in --out) out=$2; shift;; esac; shift; done
mkdir -p $out/scans/west; touch $out/scans/west/range.exr
echo '{"seconds_by_stage": {"square planes": 0.5, "superclusters": 1.5},
       "kernels": {"square_planes": {"seconds": 0.25}}}' > $out/timing.json
echo '{"program": {"version": "0.1"}, "scans": [{"square": 7, "nodes": {"measured": 1000000}}]}' > $out/summary.json
)";

struct Compare : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("hybrid-compare-" + std::to_string(getpid()));
  Compare() {
    fs::create_directories(folder / "external");
    script("bin/hybrid", kHybrid);
    script("bin/hybrid-synth", kSynth);
  }
  ~Compare() override { fs::remove_all(folder); }

  void script(const std::string& name, const std::string& body) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "#!/bin/sh\n" << body;
    fs::permissions(folder / name, fs::perms::owner_all);
  }
  Finished compare(const std::string& more) const {
    const std::string at = folder.string();
    return run_process(
        {"/bin/sh", "-c",
         "HYBRID_PEERS_DIR=" + at + "/external HYBRID_COMMIT=abc1234 exec " HYBRID_COMPARE " --bin " + at +
             "/bin --scenes " + at + "/scenes --work " + at + "/work " + more},
        50);
  }
  std::string text(const std::string& name) const {
    std::stringstream content;
    content << std::ifstream(folder / name).rdbuf();
    return content.str();
  }
  nlohmann::json row(const std::string& size, const std::string& program) const {
    const auto document = nlohmann::json::parse(text("work/compare.json"));
    for (const auto& entry : document.at("rows"))
      if (entry.at("size") == size && entry.at("program") == program) return entry;
    ADD_FAILURE() << "no row " << size << " " << program;
    return {{"runs", nlohmann::json::array()}};
  }
};

TEST_F(Compare, AProgramOfOnesOwnGetsItsRow) {
  script("external/ahc_planes",
         R"(echo "$@" >> $(dirname $0)/log
echo '{"seconds": 4, "package": "fake 7", "settings": "none | any", "samples": 800000}')");
  const auto finished = compare("--only planes --sizes 1 --rounds 2");
  ASSERT_EQ(failure_of(finished), "");
  const std::string expected = "| planes | 1 MP | AHC / PEAC | 4.00 (4.00-4.00) | 2 | 0.200 | 2.00 x |";
  EXPECT_NE(finished.output.find(expected), std::string::npos) << finished.output;
  EXPECT_NE(finished.output.find("none   any |"), std::string::npos) << finished.output;
  EXPECT_EQ(row("1 MP", "AHC / PEAC").at("package"), "fake 7");
  EXPECT_EQ(row("1 MP", "AHC / PEAC").at("runs").size(), 2u);
  EXPECT_NE(
      text("external/log").find("--range " + (folder / "work" / "ours/1/scans/west/range.exr").string()),
      std::string::npos);
}

TEST_F(Compare, AFailureIsRepeatedAndTheRestGoesOn) {
  script("external/ahc_planes", "echo thinking >&2; echo 'no plane in sight' >&2; exit 1");
  const auto finished = compare("--only planes --sizes 0.5,1 --rounds 1");
  ASSERT_EQ(failure_of(finished), "");
  EXPECT_NE(finished.output.find("| AHC / PEAC | not run: failed: exit status 1: no plane in sight |"),
            std::string::npos)
      << finished.output;
  EXPECT_EQ(row("1 MP", "AHC / PEAC").at("reason"), "failed at 0.5 MP: exit status 1: no plane in sight");
  EXPECT_EQ(row("1 MP", "hybrid planes").at("outcome"), "ran");
  EXPECT_EQ(row("1 MP", "CGAL region growing").at("reason"), "CGAL not installed when this was built");
}

// The first size is only there for slow programs; its scan is made too.
TEST_F(Compare, EverySizeHasItsScan) {
  script("external/ahc_planes", R"(echo '{"seconds": 4}')");
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1,2 --rounds 1")), "");
  for (const char* size : {"0.25", "1", "2"})
    EXPECT_TRUE(fs::exists(folder / "work" / "ours" / size / "timing.json")) << size;
  EXPECT_EQ(row("2 MP", "hybrid planes").at("outcome"), "ran");
}

TEST_F(Compare, APeerIsNotBlamedForOurFailure) {
  script("bin/hybrid",
         "case \"$*\" in *room-1/*) echo 'no device' >&2; exit 5;; esac\n" + std::string(kHybrid));
  script("external/ahc_planes", R"(echo '{"seconds": 4}')");
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1,2 --rounds 1")), "");
  EXPECT_EQ(row("1 MP", "hybrid planes").at("reason"), "failed: exit status 5: no device");
  EXPECT_EQ(row("1 MP", "AHC / PEAC").at("reason"), "no range image: hybrid planes made none");
  EXPECT_EQ(row("2 MP", "AHC / PEAC").at("outcome"), "ran");
}

TEST_F(Compare, WhatHangsIsEnded) {
  script("external/ahc_planes", "sleep 30");
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1 --run-limit 0.5")), "");
  EXPECT_EQ(row("1 MP", "AHC / PEAC").at("reason"), "failed: stopped after 0.5 s");
}

TEST_F(Compare, WithoutRoomForAScanItsRowsSaySo) {
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1,5 --rounds 1")), "");
  EXPECT_EQ(row("5 MP", "hybrid planes").at("reason"), "no scan: exit status 75: the disk has 3 MB free");
  EXPECT_EQ(row("1 MP", "hybrid planes").at("outcome"), "ran");
}

TEST_F(Compare, AtALargeSizeOnlyOursAndTheTwinRunUnlessAskedForAll) {
  script("bin/peers/twin_planes", R"(echo '{"seconds": 0.1}')");
  script("external/ahc_planes", R"(echo '{"seconds": 4, "samples": 800000}')");
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1,100 --rounds 1")), "");
  EXPECT_EQ(row("100 MP", "hybrid planes").at("outcome"), "ran");
  EXPECT_EQ(row("100 MP", "C++/OpenMP RANSAC per square").at("outcome"), "ran");
  EXPECT_EQ(row("100 MP", "AHC / PEAC").at("outcome"), "extrapolated");
  EXPECT_EQ(row("100 MP", "AHC / PEAC").at("reason"), "from 1 MP");
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1,100 --rounds 1 --full")), "");
  EXPECT_EQ(row("100 MP", "AHC / PEAC").at("outcome"), "ran");
}

TEST_F(Compare, SaysWhatRanWhere) {
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1 --rounds 1")), "");
  const auto machine = nlohmann::json::parse(text("work/compare.json")).at("machine");
  for (const char* key : {"processor", "cores", "memory", "system", "compiler", "date", "minutes"})
    EXPECT_TRUE(machine.contains(key)) << key;
  EXPECT_EQ(machine.at("commit"), "abc1234");
  EXPECT_EQ(machine.at("devices").at(0).at("driver"), "7.1");
  EXPECT_EQ(machine.at("packages").at(0), "hybrid 0.1");
  const std::string heading = text("work/compare.md").substr(0, 600);
  EXPECT_NE(heading.find("commit abc1234"), std::string::npos) << heading;
  EXPECT_NE(heading.find("fake device, driver 7.1"), std::string::npos) << heading;
  EXPECT_NE(text("work/planes-time.svg").find(">hybrid planes</text>"), std::string::npos);
  EXPECT_NE(text("work/planes-memory.svg").find(">MB</text>"), std::string::npos);
}

TEST_F(Compare, ReplacesTheTableOfAResultsFile) {
  fs::create_directories(folder / "bench" / "peers");
  std::ofstream(folder / "bench" / "RESULTS.md")
      << "before\n<!-- compare.sh: begin -->\nold\n<!-- compare.sh: end -->\nafter\n";
  const std::string option = " --write-results " + (folder / "bench" / "RESULTS.md").string();
  ASSERT_EQ(failure_of(compare("--only planes --sizes 1 --rounds 1" + option)), "");
  const std::string results = text("bench/RESULTS.md");
  EXPECT_EQ(results.find("before\n"), 0u);
  EXPECT_NE(results.find("\n<!-- compare.sh: end -->\nafter\n"), std::string::npos);
  EXPECT_EQ(results.find("old"), std::string::npos);
  EXPECT_NE(results.find("| planes | 1 MP | **hybrid planes** |"), std::string::npos) << results;
  EXPECT_TRUE(fs::exists(folder / "bench" / "peers" / "planes-time.svg"));
  std::ofstream(folder / "bench" / "RESULTS.md") << "no marks\n";
  const auto refused = compare("--only planes --sizes 1 --rounds 1" + option);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.errors.find("expected the lines <!-- compare.sh: begin -->"), std::string::npos);
  EXPECT_EQ(text("bench/RESULTS.md"), "no marks\n");
}

TEST_F(Compare, ReadingE57RunsOursAndThePeers) {
  ASSERT_EQ(failure_of(compare("--only e57")), "");
  EXPECT_EQ(row("a scan", "libE57Format").at("reason"), "not in HYBRID_PEERS_DIR");
  script("external/libe57_read",
         R"(echo '{"seconds": 2, "package": "libE57Format 3", "samples": 16000000}')");
  script("bin/hybrid-read-bench", R"(echo '{"seconds": 0.5, "package": "hybrid", "samples": 16000000}')");
  std::ofstream(folder / "hall.e57") << "a scan";
  const auto finished = compare("--only e57 --e57 " + (folder / "hall.e57").string());
  ASSERT_EQ(failure_of(finished), "");
  EXPECT_NE(finished.output.find("| reading E57 | hall.e57 | libE57Format | 2.00 (2.00-2.00) | 3 | 8.00 |"),
            std::string::npos)
      << finished.output;
  EXPECT_NE(finished.output.find("| reading E57 | hall.e57 | **hybrid** | 0.500 (0.500-0.500) | 3 | 32.0 |"),
            std::string::npos)
      << finished.output;
}

TEST_F(Compare, EndToEndTakesChainsApartByTheirParts) {
  script("bin/hybrid-synth", R"(
while [ $# -gt 0 ]; do
  case $1 in --out) out=$2; shift;; --format) format=$2; shift;; --only-scan) id=$2; shift;; esac; shift
done
[ "$format" = e57 ] || exit 2
mkdir -p $out; touch $out/scene.toml
echo '{"noise_m": 0.0015, "scans": [{"id": "'$id'",
       "world_from_scan": [1,0,0,1, 0,1,0,2, 0,0,1,3, 0,0,0,1]}]}' > $out/truth.json
)");
  script("bin/hybrid", R"(
if [ "$1" = devices ]; then echo '[]'; exit; fi
grep -q '^pose = \[' $2 || exit 4
id=$(grep '^id = ' $2 | cut -d '"' -f 2)
while [ $# -gt 0 ]; do case $1 in --out) out=$2; shift;; esac; shift; done
mkdir -p $out/scans/$id; touch $out/scans/$id/range.exr
echo '{"world_from_scan": [1,0,0,1, 0,1,0,2, 0,0,1,3.001, 0,0,0,1]}' > $out/scans/$id/pose.json
echo '{"seconds_by_stage": {"read": 1, "resample": 0.5, "square planes": 2, "superclusters": 0.25,
       "contours": 0.5, "ICP": 4, "decimate": 8, "write": 16}}' > $out/timing.json
echo '{"program": {"version": "0.1"}, "scans": [{"nodes": {"measured": 1000},
       "decimation": {"discarded_share": 0.9}}]}' > $out/summary.json
)");
  script("bin/peers/pcl_chain", R"(
echo "$@" >> $(dirname $0)/log
while [ $# -gt 0 ]; do case $1 in --scan) scan=$2; shift;; --prepare) touch $scan; exit;; esac; shift; done
[ -e $scan ] || exit 1
echo '{"seconds": 4, "package": "PCL 9", "settings": "s", "samples": 900,
  "parts": {"read": 0.5, "planes": 3, "register": 2, "decimate": 0.125, "write": 1},
  "discarded_share": 0.95, "world_from_scan": [1,0,0,1, 0,1,0,2, 0,0,1,3, 0,0,0,1]}' | tr -d '\n'
)");
  fs::create_directories(folder / "bench");
  std::ofstream(folder / "bench" / "RESULTS.md")
      << "before\n<!-- end_to_end.sh: begin -->\n\nold run\n\n| job | size |\n|---|---|\n| room | 1 MP | old "
         "|\n"
         "\nolder run\n\n| job | size |\n|---|---|\n| room | 1 MP | old |\n| room | 20 MP | kept |\n\n"
         "<!-- end_to_end.sh: end -->\nafter\n";
  const auto finished = compare("--only end-to-end --sizes 1 --rounds 2 --write-results " +
                                (folder / "bench" / "RESULTS.md").string());
  ASSERT_EQ(failure_of(finished), "");
  const std::string table = text("bench/RESULTS.md");
  for (const char* line :
       {"| room | 1 MP | **hybrid run** | 1.50 | 2.75 | 4.00 | 8.00 | 16.0 |",
        "| church | 1 MP | **hybrid run** | 1.50 | 2.75 | 4.00 | 8.00 | 16.0 |",
        "| room | 1 MP | PCL chain, gradient | 0.500 | 3.00 | 2.00 | 0.125 | 1.00 |",
        "| church | 1 MP | PCL chain, covariance | 0.500 |", "; 0.0000 deg, 1.00 mm; 90 % discarded |"})
    EXPECT_NE(table.find(line), std::string::npos) << line << "\n" << table;
  // What was not run stays under its own heading; what was, and headings of nothing, go.
  EXPECT_EQ(table.find("| old |"), std::string::npos);
  EXPECT_EQ(table.find("old run"), std::string::npos);
  EXPECT_NE(table.find(" |\n\nolder run\n\n| job | size |\n|---|---|\n| room | 20 MP | kept |\n\n<!-- end"),
            std::string::npos)
      << table;
  const auto entry =
      nlohmann::json::parse(text("work/end_to_end.json")).at("rows").at(1);  // seconds: of the process
  EXPECT_EQ(entry.at("runs").size(), 2u);
  EXPECT_EQ(entry.at("runs").at(0).at("seconds"), entry.at("runs").at(0).at("process_s"));
  const std::string log = text("bin/peers/log");
  const auto prepared = log.find("--prepare"), again = log.find("--prepare", prepared + 1);
  EXPECT_NE(again, std::string::npos);  // once for all variants and rounds of a scene
  EXPECT_EQ(log.find("--prepare", again + 1), std::string::npos);
  EXPECT_NE(log.find("--sigma 0.0015"), std::string::npos);  // peers are told the truth
}

TEST_F(Compare, BadOptionsAreTold) {
  for (const char* options : {"--fast", "--only lunch", "--rounds 0", "--sizes 1,x", "--sizes 5,1",
                              "--sizes ,", "--minutes -1", "--e57 /no/such.e57"}) {
    const auto finished = compare(options);
    EXPECT_EQ(finished.exit_code, 2) << options;
    EXPECT_NE(finished.errors, "") << options;
    EXPECT_EQ(finished.output, "") << options;
  }
}

}  // namespace
}  // namespace hybrid::compare
