// PCL's own chain for organised clouds (pcl_organised.hpp). Variants: how normals are found, and whether the
// scan's holes are filled first (`-holes`: not).
#include <pcl/console/print.h>
#include <pcl/pcl_config.h>

#include "planes/pcl_cloud.hpp"
#include "planes/pcl_organised.hpp"
#include "shared/planes_peer.hpp"

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return planes_main(
      argc, argv, "PCL " PCL_VERSION_PRETTY, {"covariance", "gradient", "covariance-holes", "gradient-holes"},
      [](const RangeScan& scan, const PlanesOptions& options, Report& report) {
        const bool gradient = options.variant.starts_with("gradient"),
                   holes = options.variant.ends_with("holes");
        const auto cloud = organised_cloud(holes ? with_holes(scan) : with_holes_filled(scan));
        // Converting is not what a PCL user, whose data start in PCL's form, would wait for.
        const Stopwatch watch;
        auto found = find_organised_planes(cloud, gradient, scan.measured(), options.sigma_m);
        report.seconds = watch.seconds();
        report.parts["normals"] = found.normals_s;
        report.settings = found.settings + (holes ? ", the scan's holes left in" : ", holes filled");
        return found.labels;
      });
}
