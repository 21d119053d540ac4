// CGAL's efficient RANSAC (Schnabel et al. 2007), planes only.
#include <CGAL/Shape_detection/Efficient_RANSAC.h>

#include "planes/cgal_cloud.hpp"

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  using Traits =
      CGAL::Shape_detection::Efficient_RANSAC_traits<CgalKernel, CgalCloud, CgalPointMap, CgalNormalMap>;
  using Ransac = CGAL::Shape_detection::Efficient_RANSAC<Traits>;
  return planes_main(
      argc, argv, "CGAL " CGAL_VERSION_STR, {"planes"},
      [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(options.threads));
        CGAL::get_default_random() = CGAL::Random(1);
        const Stopwatch watch;
        const auto nodes = valid_nodes(scan);
        CgalCloud cloud = cgal_cloud(scan, nodes);
        report.parts["normals"] = watch.seconds();
        Ransac ransac;
        ransac.set_input(cloud);
        ransac.add_shape_factory<CGAL::Shape_detection::Plane<Traits>>();
        Ransac::Parameters parameters;
        parameters.probability = 0.01;
        parameters.min_points = least_points(nodes.size());
        parameters.epsilon = 3 * options.sigma_m;
        parameters.cluster_epsilon = 0.1;
        parameters.normal_threshold = 0.8;
        ransac.detect(parameters);
        std::vector<std::uint32_t> labels(scan.count(), 0);
        std::uint32_t plane = 0;
        for (const auto& shape : ransac.shapes()) {
          ++plane;
          for (std::size_t i : shape->indices_of_assigned_points()) labels[std::get<2>(cloud[i])] = plane;
        }
        report.settings =
            "12 neighbours' normals within 37 degrees, 3 sigma, clusters at 10 cm, search on 1 thread";
        return labels;
      });
}
