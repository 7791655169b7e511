#include "bench/topology/vtk_surfaces.h"

#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "tests/support/mesh_checks.h"

namespace geosis::bench {
namespace {

/// VTK's x runs fastest, so x is the sample axis.
template <class Filter>
IndexedMesh run(const test::ScalarField& field, float level) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(field.shape.samples, field.shape.crosslines, field.shape.inlines);
  vtkNew<vtkFloatArray> values;
  values->SetNumberOfValues(static_cast<vtkIdType>(field.samples.size()));
  for (std::size_t n = 0; n < field.samples.size(); ++n) values->SetValue(static_cast<vtkIdType>(n), field.samples[n]);
  image->GetPointData()->SetScalars(values);
  vtkNew<Filter> filter;
  filter->SetInputData(image);
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  filter->SetValue(0, level);
  filter->Update();

  vtkPolyData* surface = filter->GetOutput();
  IndexedMesh mesh;
  for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p) {
    const double* x = surface->GetPoint(p);
    mesh.positions.push_back({static_cast<float>(x[2]), static_cast<float>(x[1]), static_cast<float>(x[0])});
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c) {
    surface->GetCellPoints(c, corners);
    mesh.triangles.push_back({static_cast<std::int32_t>(corners->GetId(0)),
                              static_cast<std::int32_t>(corners->GetId(1)),
                              static_cast<std::int32_t>(corners->GetId(2))});
  }
  return test::welded(mesh);
}

}  // namespace

IndexedMesh vtk_marching_cubes(const test::ScalarField& field, float level) {
  return run<vtkMarchingCubes>(field, level);
}

IndexedMesh vtk_flying_edges(const test::ScalarField& field, float level) {
  return run<vtkFlyingEdges3D>(field, level);
}

}  // namespace geosis::bench
