// CGAL's region growing over nearest neighbours, least squares planes; seeds sorted by how planar they are.
#include <CGAL/Shape_detection/Region_growing/Region_growing.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing_on_point_set.h>

#include "planes/cgal_cloud.hpp"

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  namespace growing = CGAL::Shape_detection;
  using Neighbours = growing::Point_set::K_neighbor_query<CgalKernel, CgalCloud, CgalPointMap>;
  using Region =
      growing::Point_set::Least_squares_plane_fit_region<CgalKernel, CgalCloud, CgalPointMap, CgalNormalMap>;
  using Sorting =
      growing::Point_set::Least_squares_plane_fit_sorting<CgalKernel, CgalCloud, Neighbours, CgalPointMap>;
  using Growing = growing::Region_growing<CgalCloud, Neighbours, Region, Sorting::Seed_map>;
  return planes_main(
      argc, argv, "CGAL " CGAL_VERSION_STR, {"sorted", "plain"},
      [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(options.threads));
        const Stopwatch watch;
        const auto nodes = valid_nodes(scan);
        const CgalCloud cloud = cgal_cloud(scan, nodes);
        report.parts["normals"] = watch.seconds();
        Neighbours neighbours(cloud, 12, CgalPointMap());
        Region region(cloud, 4 * options.sigma_m + 0.002, 20, least_points(nodes.size()), CgalPointMap(),
                      CgalNormalMap());
        std::vector<std::vector<std::size_t>> regions;
        if (options.variant == "sorted") {
          Sorting sorting(cloud, neighbours, CgalPointMap());
          sorting.sort();
          Growing(cloud, neighbours, region, sorting.seed_map()).detect(std::back_inserter(regions));
        } else {
          growing::Region_growing<CgalCloud, Neighbours, Region>(cloud, neighbours, region)
              .detect(std::back_inserter(regions));
        }
        std::vector<std::uint32_t> labels(scan.count(), 0);
        for (std::size_t plane = 0; plane < regions.size(); ++plane)
          for (std::size_t i : regions[plane])
            labels[std::get<2>(cloud[i])] = static_cast<std::uint32_t>(plane) + 1;
        report.settings = "12 neighbours, 20 degrees" +
                          std::string(options.variant == "sorted" ? ", seeds sorted" : "") +
                          ", growing on 1 thread";
        return labels;
      });
}
