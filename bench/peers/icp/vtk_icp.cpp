// vtkIterativeClosestPointTransform, which the paper used: closest points on the proxy's own polygons.
#include <vtkCellArray.h>
#include <vtkIterativeClosestPointTransform.h>
#include <vtkLandmarkTransform.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkVersionMacros.h>

#include "shared/icp_peer.hpp"

namespace hybrid::peers {
namespace {

// Starts from the given pose: VTK knows no start, so the points are moved there.
vtkNew<vtkPolyData> source_of(const IcpInput& input) {
  vtkNew<vtkPoints> points;
  for (const PlyPoint& p : input.source) {
    const Eigen::Vector4d q = input.start * Eigen::Vector4d(p[0], p[1], p[2], 1);
    points->InsertNextPoint(q.data());
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  return data;
}

vtkNew<vtkPolyData> target_of(const ProxyMesh& mesh) {
  vtkNew<vtkPoints> points;
  for (const auto& v : mesh.vertices) points->InsertNextPoint(v.data());
  vtkNew<vtkCellArray> cells;
  for (const auto& triangle : mesh.triangles) {
    cells->InsertNextCell(3);
    for (std::uint32_t corner : triangle) cells->InsertCellPoint(corner);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

}  // namespace
}  // namespace hybrid::peers

int main(int argc, char** argv) {
  using namespace hybrid::peers;
  return icp_main(argc, argv, "VTK " VTK_VERSION, {"rigid"}, [](const IcpInput& input, Report& report) {
    const auto source = source_of(input);
    const auto target = target_of(input.proxy);
    vtkNew<vtkIterativeClosestPointTransform> icp;
    icp->SetSource(source);
    icp->SetTarget(target);
    icp->GetLandmarkTransform()->SetModeToRigidBody();
    icp->SetMaximumNumberOfIterations(50);
    icp->SetMaximumNumberOfLandmarks(static_cast<int>(input.source.size()));
    const Stopwatch watch;
    icp->Update();
    report.seconds = watch.seconds();
    report.settings =
        "50 iterations, all points as landmarks, no gate (it has none), 1 thread (it has no more)";
    Eigen::Matrix4d step;
    for (int i = 0; i < 16; ++i) step(i / 4, i % 4) = icp->GetMatrix()->GetElement(i / 4, i % 4);
    return IcpResult{step * input.start, icp->GetNumberOfIterations()};
  });
}
