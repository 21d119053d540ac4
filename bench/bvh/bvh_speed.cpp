// How fast the tree of a scene's splats is built, what it holds and what it takes at its most, and what rays
// through it cost. Splats are samples of surfaces as scanners make them: a vaulted nave of 44 x 18 x 14 m
// with round columns, equal angles from four stations, 2 mm of noise along the rays, radius the local
// spacing. Wall and processor time, since machines are shared; the digest of a tree is the same for any
// --threads.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "core/free_memory.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace {
using namespace hybrid;

constexpr double kLength_m = 44, kWidth_m = 18, kSpring_m = 5;  // the vault: a half cylinder above kSpring_m
constexpr double kColumn_m = 0.6;                               // radius
constexpr double kNoise_m = 0.002;
const std::array<Vec3, 4> kStations = {Vec3(-15, 2, 1.7), Vec3(-5, -1, 1.7), Vec3(6, 1.5, 1.7),
                                       Vec3(16, -2, 1.7)};

// Even in [0, 1), from a counter alone.
double chance(std::uint64_t of) {
  of += 0x9E3779B97F4A7C15ull;
  of = (of ^ (of >> 30)) * 0xBF58476D1CE4E5B9ull;
  of = (of ^ (of >> 27)) * 0x94D049BB133111EBull;
  return static_cast<double>((of ^ (of >> 31)) >> 11) * 0x1p-53;
}

struct Hit {
  double t = INFINITY;
  Vec3 normal = Vec3::Zero();
  void nearer(double at, const Vec3& n) {
    if (at > 1e-9 && at < t) t = at, normal = n;
  }
};

// Entry (side -1) or exit (side 1) of an upright (axis z) or lying (axis x) cylinder.
void hit_cylinder(const Vec3& eye, const Vec3& ray, const Vec3& on_axis, const Vec3& axis, double radius,
                  int side, Hit& hit) {
  const Vec3 to = eye - on_axis - axis * axis.dot(eye - on_axis), across = ray - axis * axis.dot(ray);
  const double a = across.squaredNorm(), b = to.dot(across), c = to.squaredNorm() - radius * radius;
  if (a < 1e-18 || b * b - a * c < 0) return;
  const double t = (-b + side * std::sqrt(b * b - a * c)) / a;
  hit.nearer(t, -side * (to + t * across).normalized());
}

Hit hit_nave(const Vec3& eye, const Vec3& ray) {
  Hit hit;
  for (const double side : {-1.0, 1.0}) {
    if (ray.x() * side > 0) hit.nearer((side * kLength_m / 2 - eye.x()) / ray.x(), {-side, 0, 0});
    if (ray.y() * side > 0) hit.nearer((side * kWidth_m / 2 - eye.y()) / ray.y(), {0, -side, 0});
  }
  if (ray.z() < 0) hit.nearer(-eye.z() / ray.z(), {0, 0, 1});
  Hit vault;
  hit_cylinder(eye, ray, {0, 0, kSpring_m}, Vec3::UnitX(), kWidth_m / 2, 1, vault);
  if (vault.t < INFINITY && eye.z() + vault.t * ray.z() > kSpring_m) hit.nearer(vault.t, vault.normal);
  for (int i = 0; i < 14; ++i)
    hit_cylinder(eye, ray, {-18.0 + 6 * (i / 2), i % 2 ? 5.0 : -5.0, 0}, Vec3::UnitZ(), kColumn_m, -1, hit);
  return hit;
}

std::vector<stages::Splat> make_nave(std::size_t count) {
  const std::size_t each = (count + kStations.size() - 1) / kStations.size();
  const auto rows = static_cast<std::size_t>(std::sqrt(static_cast<double>(each) / 2)),
             cols = each / rows + 1;
  const double step = M_PI / static_cast<double>(rows);
  std::vector<stages::Splat> splats(count);
  parallel_for(
      count,
      [&](std::size_t i) {
        const std::size_t station = i / each, sample = i % each;
        const double up = M_PI / 2 - step * (static_cast<double>(sample % rows) + 0.5);
        const double round = 2 * M_PI * static_cast<double>(sample / rows) / static_cast<double>(cols);
        const Vec3 ray(std::cos(up) * std::cos(round), std::cos(up) * std::sin(round), std::sin(up));
        const Hit hit = hit_nave(kStations[station], ray);
        const double noise = kNoise_m * (chance(2 * i) + chance(2 * i + 1) - 1) * std::sqrt(6.0);
        const Vec3f at = (kStations[station] + (hit.t + noise) * ray).cast<float>();
        const Vec3f n = hit.normal.cast<float>();
        splats[i] = {{at.x(), at.y(), at.z()},
                     static_cast<float>(step * hit.t),
                     {n.x(), n.y(), n.z()},
                     static_cast<std::uint32_t>(station)};
      },
      4096);
  return splats;
}

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// MiB resident now ("VmRSS:") or at most since forget_peak() ("VmHWM:").
double memory_mib(const std::string& which) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == which) {
      double kib = 0;
      status >> kib;
      return kib / 1024;
    }
  return NAN;
}
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

struct Clock {
  Timer wall;
  double cpu = processor_s();
  void report(const char* what, std::size_t items) const {
    const double wall_s = wall.seconds(), cpu_s = processor_s() - cpu;
    std::printf("  %-28s %7.3f s wall, %7.3f s processor: %6.2f M/s, %6.2f M per processor second\n", what,
                wall_s, cpu_s, 1e-6 * static_cast<double>(items) / wall_s,
                1e-6 * static_cast<double>(items) / cpu_s);
  }
};

template <typename T>
double mib(const std::vector<T>& values) {
  return static_cast<double>(values.capacity() * sizeof(T)) / 1048576;
}

std::uint64_t digest(const stages::Bvh& bvh) {
  std::uint64_t sum = 0xcbf29ce484222325ull;
  const auto add = [&](const auto& values) {
    const auto* words = reinterpret_cast<const std::uint32_t*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof values[0] / 4; ++i)
      sum = (sum ^ words[i]) * 0x100000001b3ull;
  };
  add(bvh.nodes), add(bvh.spheres), add(bvh.sphere_source);
  return sum;
}

// What a ray meets on average by the surface area heuristic: nodes, and spheres of their leaves.
std::array<double, 2> expected(const stages::Bvh& bvh) {
  double nodes = 0, spheres = 0, whole = 0;
  for (const BvhNode& node : bvh.nodes)
    for (std::size_t k = 0; k < BVH_WIDTH && node.child[k] != BVH_EMPTY; ++k) {
      const double x = node.high_x[k] - node.low_x[k], y = node.high_y[k] - node.low_y[k],
                   z = node.high_z[k] - node.low_z[k], area = x * y + y * z + z * x;
      if (&node == bvh.nodes.data()) whole += area;  // close enough to the root's own box
      if (node.child[k] & BVH_LEAF)
        spheres += area * (((node.child[k] >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1);
      else
        nodes += area;
    }
  return {nodes / whole, spheres / whole};
}

void time_tree(std::size_t count, int runs) {
  std::vector<SphereRecord> spheres;
  {
    const auto splats = make_nave(count);
    spheres.resize(count);
    parallel_for(count, [&](std::size_t i) {
      const auto& s = splats[i];
      spheres[i] = {{s.centre_m[0], s.centre_m[1], s.centre_m[2]}, s.radius_m};
    });
  }
  for (int run = 0; run < runs; ++run) {
    forget_peak();
    const double before = memory_mib("VmRSS:");
    const Clock clock;
    const stages::Bvh bvh = stages::build_bvh({}, spheres);
    clock.report("tree", count);
    const double peak = memory_mib("VmHWM:");
    if (run > 0) continue;
    const auto [nodes, leaves] = expected(bvh);
    std::printf(
        "  tree holds %.0f MiB (%zu nodes %.0f, spheres %.0f, their sources %.0f); %.0f MiB more at most "
        "while building; digest %016llx\n",
        mib(bvh.nodes) + mib(bvh.spheres) + mib(bvh.sphere_source), bvh.nodes.size(), mib(bvh.nodes),
        mib(bvh.spheres), mib(bvh.sphere_source), peak - before,
        static_cast<unsigned long long>(digest(bvh)));
    std::printf("  surface area heuristic: a ray meets %.2f nodes and %.2f spheres\n", nodes, leaves);
  }
}

// A view of the splats as hybrid render makes it: geometry on the device, then the rays of 1080p.
void time_view(device::Queue& queue, std::size_t count, int runs) {
  forget_peak();
  stages::RenderScene scene;
  scene.splats = make_nave(count);
  const Clock making;
  const stages::DeviceBvh geometry = stages::make_render_geometry(queue, scene, "scan", Vec3::Zero());
  making.report("geometry on the device", count);
  const Photograph view = look_at({-20, 3, 2.2}, {0, 0, 1.8}, Vec3::UnitZ(), 57, 1920, 1080);
  stages::SurfaceTile tile(queue, 1920 * 1080);
  for (int run = 0; run <= runs; ++run) {
    const Clock clock;
    stages::cast_tile(queue, geometry, stages::camera_record(view, Vec3::Zero()), {0, 0, 1080, 1920},
                      {0.5f, 0.5f}, 0.02, tile);
    queue.finish();
    if (run > 0) clock.report("1080p rays", tile.count());  // the first builds the kernel
  }
  std::printf("  %.0f MiB at most, all in all: splats, tree, its copy on the device\n", memory_mib("VmHWM:"));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Speed and memory of the tree of splats");
  std::vector<double> millions = {1, 5, 20};
  int threads = 0, runs = 3;
  bool view = false;
  app.add_option("--millions", millions, "of splats")->delimiter(',');
  app.add_option("--threads", threads, "0 = all cores");
  app.add_option("--runs", runs);
  app.add_flag("--view", view, "also a view through the device, with the peak of the whole program");
  CLI11_PARSE(app, argc, argv);
  set_thread_count(threads);
  for (const double size : millions) {
    std::string load;
    std::getline(std::ifstream("/proc/loadavg"), load);
    std::printf("%g M splats, %d threads, load %s\n", size, thread_count(), load.c_str());
    const auto count = static_cast<std::size_t>(size * 1e6);
    time_tree(count, runs);
    if (view) {
      device::Queue queue("");
      time_view(queue, count, runs);
    }
  }
}
