#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include "bench/engine/simplify/peers.h"

namespace geosis {

IndexedMesh simplify_with_vtk(const IndexedMesh& m0, std::size_t triangles) {
  vtkNew<vtkPoints> points;
  for (const Vec3f p : m0.positions) points->InsertNextPoint(p.x, p.y, p.z);
  vtkNew<vtkCellArray> cells;
  for (const Triangle& triangle : m0.triangles) cells->InsertNextCell({triangle[0], triangle[1], triangle[2]});
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(points);
  surface->SetPolys(cells);
  vtkNew<vtkQuadricDecimation> decimation;
  decimation->SetInputData(surface);
  decimation->SetTargetReduction(1 - static_cast<double>(triangles) / static_cast<double>(m0.triangles.size()));
  decimation->VolumePreservationOn();
  decimation->Update();
  vtkPolyData* output = decimation->GetOutput();
  IndexedMesh level;
  for (vtkIdType v = 0; v < output->GetNumberOfPoints(); ++v) {
    const double* p = output->GetPoint(v);
    level.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  vtkNew<vtkIdList> ids;
  vtkCellArray* polys = output->GetPolys();
  for (polys->InitTraversal(); polys->GetNextCell(ids) != 0;) {
    level.triangles.push_back({static_cast<std::int32_t>(ids->GetId(0)), static_cast<std::int32_t>(ids->GetId(1)),
                               static_cast<std::int32_t>(ids->GetId(2))});
  }
  return level;
}

}  // namespace geosis
