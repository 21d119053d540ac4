// The same bytes for any thread count: PoCL reads its thread count once per process, so each count gets a
// process of its own, which prints a digest of a registration's bits.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "cases/recess_room.hpp"
#include "core/parallel.hpp"
#include "device.hpp"
#include "places.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages {
namespace {

using namespace hybrid::testing;

class Digest {
 public:
  template <typename T>
  void add(const T* values, std::size_t count) {
    std::vector<unsigned char> bytes(count * sizeof(T));
    if (count) std::memcpy(bytes.data(), values, bytes.size());
    for (unsigned char byte : bytes) value_ = (value_ ^ byte) * 1099511628211ull;  // FNV-1a
  }
  std::string text() const { return fmt::format("digest {:016x}", value_); }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

std::string digest_with_threads(int threads) {
  const std::string command =
      fmt::format("HYBRID_TEST_THREADS={} '{}/hybrid_tests' --gtest_filter=IcpThreads.prints_a_digest 2>&1",
                  threads, HYBRID_BIN_DIR);
  FILE* child = popen(command.c_str(), "r");
  if (!child) return "no child process";
  std::string output, digest = "no digest";
  char line[512];
  while (std::fgets(line, sizeof line, child)) {
    output += line;
    if (std::strncmp(line, "digest ", 7) == 0) digest = line;
  }
  return pclose(child) == 0 ? digest : output;
}

}  // namespace

TEST(IcpThreads, prints_a_digest) {
  if (const char* threads = std::getenv("HYBRID_TEST_THREADS")) set_thread_count(std::atoi(threads));
  const auto scan = scan_recess_room(150, 301, 0.002);
  const auto samples = choose_planar_samples(scan.image, scan.segmentation, 20000, 1);
  const auto found =
      register_to_model(queue(), samples, scan.proxy, disturbed(scan.world_from_scan, 0.3, 10, 1));
  const auto distances =
      distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, found.world_from_scan, 45);
  Digest digest;
  digest.add(samples.points.data(), samples.points.size());
  digest.add(row_major(found.world_from_scan).data(), 16);
  digest.add(found.covariance.data(), found.covariance.size());
  digest.add(found.rms_history_m.data(), found.rms_history_m.size());
  digest.add(distances.data(), distances.size());
  EXPECT_TRUE(found.converged);
  std::printf("%s\n", digest.text().c_str());
}

TEST(IcpThreads, one_thread_and_two_give_the_same_bytes) {
  const std::string one = digest_with_threads(1), two = digest_with_threads(2);
  EXPECT_EQ(one.substr(0, 7), "digest ") << one;
  EXPECT_EQ(one, two);
}

}  // namespace hybrid::stages
