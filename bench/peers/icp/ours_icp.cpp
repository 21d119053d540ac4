// Our registration in the peers' frame: the stage that `hybrid register` runs, from the same samples and
// start. "plane" is the default; "paper" is Besl and McKay's closest points with Horn's rotation, as in 2004.
#include "core/parallel.hpp"
#include "io/models/obj.hpp"
#include "shared/icp_peer.hpp"
#include "shared/pose_json.hpp"
#include "stages/registration/icp.hpp"

int main(int argc, char** argv) {
  using namespace hybrid;
  return peers::icp_main(
      argc, argv, "hybrid", {"plane", "paper"}, [](const peers::IcpInput& input, peers::Report& report) {
        set_thread_count(input.threads);
        device::Queue queue;
        const PolygonModel model = io::read_obj(input.proxy_file);
        stages::PlanarSamples samples;
        for (const auto& [x, y, z, nx, ny, nz, area] : input.source) {
          samples.points.push_back({x, y, z, area});
          samples.normals.push_back({nx, ny, nz, 0});
        }
        stages::IcpOptions options;
        options.max_samples = 0;
        if (input.variant == "paper") {
          options.step = "point";
          options.robust = "none";
          options.normal_deg = 180;
        }
        std::array<double, 16> start{};
        for (int i = 0; i < 16; ++i) start[static_cast<std::size_t>(i)] = input.start(i / 4, i % 4);
        const peers::Stopwatch watch;
        const auto result =
            stages::register_to_model(queue, samples, model, pose_from_row_major(start), options);
        report.seconds = watch.seconds();
        double device_s = 0;
        for (const auto& [label, row] : queue.profile()) device_s += row.seconds;
        report.parts["device"] = device_s;
        report.settings =
            (input.variant == "paper" ? std::string("the paper's: closest points, Horn")
                                      : std::string("point-to-plane, Tukey weights, compatible normals")) +
            "; kernels " + std::to_string(device_s) + " s";
        const auto numbers = row_major(result.world_from_scan);
        Eigen::Matrix4d pose;
        for (int i = 0; i < 16; ++i) pose(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)];
        return peers::IcpResult{pose, result.iterations};
      });
}
