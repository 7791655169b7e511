// topology_of_peers [DIR [SET]]: the share of random fields whose level set {f = 0} has the right Euler characteristic
// and number of components and is a manifold, closed where the field is. With DIR, writes the fields there, and judges
// when skimage_surfaces.py has put its meshes beside them. SET: that set of fields alone.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/isosurface/extract.h"
#include "engine/mesh/components.h"
#include "engine/volume/brick_file.h"
#include "tests/support/body_oracle.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/phantoms.h"
#ifdef GEOSIS_HAS_VTK
#include "bench/topology/vtk_surfaces.h"
#endif

namespace geosis::bench {
namespace {

using test::Random;
using test::ScalarField;

struct FieldSet {
  std::string name;
  int fields = 0;
  bool closed = false;  ///< the level set meets no border: components are compared, and it must be closed
  std::uint64_t seed = 0;
  std::function<ScalarField(Random&)> make;
};

std::vector<FieldSet> field_sets() {
  const auto noise = [](GridShape shape) {
    return [shape](Random& r) { return test::uniform_noise(shape, r, -1, 1); };
  };
  const auto scaled = [](Random& r) {
    ScalarField field = test::uniform_noise({5, 5, 5}, r, -1, 1);
    for (float& f : field.samples) f *= 1e-4f;
    return field;
  };
  return {
      {"random5_open", 1000, false, 51, noise({5, 5, 5})},
      {"random5_closed", 1000, true, 52,
       [](Random& r) {
         return test::with_outer_layer(test::uniform_noise({5, 5, 5}, r, -1, 1), -2);
       }},
      {"random8_open", 300, false, 81, noise({8, 8, 8})},
      {"scaled5_open", 1000, false, 53, scaled},
      {"integers5_on_level", 1000, true, 54,
       [](Random& r) {
         return test::with_outer_layer(test::integer_noise({5, 5, 5}, r, -3, 3), -4);
       }},
  };
}

IndexedMesh ours(const ScalarField& field) {
  NoProgress progress;
  const auto volume = make_bricked_volume(field.shape, field.samples);
  const GridBox all{{0, 0, 0}, {field.shape.inlines - 1, field.shape.crosslines - 1, field.shape.samples - 1}};
  auto mesh =
      extract_body(*volume, {0, std::numeric_limits<float>::infinity()}, {.cap = false, .region = all}, progress);
  return mesh ? std::move(mesh).value() : IndexedMesh{};
}

bool is_right(const IndexedMesh& mesh, const ScalarField& field, const FieldSet& set) {
  constexpr IsoRange kAbove{0, std::numeric_limits<float>::infinity()};
  const test::MeshCensus found = test::census(mesh);
  if (set.closed) {
    const auto expected = test::expected_surface(field, kAbove, BodyMode::exact);
    return found.is_closed_manifold() && found.euler() == expected.euler && found.components == expected.components;
  }
  return found.is_manifold() && found.euler() == test::expected_open_surface(field, kAbove, BodyMode::exact).euler;
}

/// Whether more than one topology is right.
bool is_tied(const ScalarField& field) {
  constexpr IsoRange kAbove{0, std::numeric_limits<float>::infinity()};
  return !test::expected_open_surface(field, kAbove, BodyMode::exact).decided;
}

using Program = std::function<IndexedMesh(const ScalarField&, int)>;

void judge(const FieldSet& set, const std::string& name, const Program& program) {
  Random random(set.seed);
  int right = 0, manifold = 0, judged = 0;
  for (int n = 0; n < set.fields; ++n) {
    const ScalarField field = set.make(random);
    const IndexedMesh mesh = program(field, n);
    const test::MeshCensus found = test::census(mesh);
    manifold += set.closed ? found.is_closed_manifold() : found.is_manifold();
    if (is_tied(field)) continue;
    ++judged;
    right += is_right(mesh, field, set);
  }
  std::printf("| %s | %s | %.1f %% of %d | %.1f %% of %d |\n", set.name.c_str(), name.c_str(), 100.0 * right / judged,
              judged, 100.0 * manifold / set.fields, set.fields);
  std::fflush(stdout);
}

std::filesystem::path file_of(const std::filesystem::path& folder, const FieldSet& set) {
  return folder / (set.name + ".f32");
}

/// All fields of a set, one after the other, as float32.
void write_fields(const std::filesystem::path& folder, const FieldSet& set) {
  Random random(set.seed);
  std::ofstream out(file_of(folder, set), std::ios::binary);
  for (int n = 0; n < set.fields; ++n) {
    const ScalarField field = set.make(random);
    out.write(reinterpret_cast<const char*>(field.samples.data()),
              static_cast<std::streamsize>(field.samples.size() * sizeof(float)));
  }
}

template <class T>
std::vector<T> read_items(std::ifstream& in, std::size_t count) {
  std::vector<T> items(count);
  in.read(reinterpret_cast<char*>(items.data()), static_cast<std::streamsize>(count * sizeof(T)));
  return items;
}

/// Meshes in the order of the fields: int32 vertices, int32 triangles, float32 positions, int32 corners.
std::vector<IndexedMesh> read_meshes(const std::filesystem::path& file, int count) {
  std::ifstream in(file, std::ios::binary);
  std::vector<IndexedMesh> meshes(static_cast<std::size_t>(count));
  for (IndexedMesh& mesh : meshes) {
    const auto counts = read_items<std::int32_t>(in, 2);
    if (!in) return {};
    mesh.positions = read_items<Vec3f>(in, static_cast<std::size_t>(counts[0]));
    mesh.triangles = read_items<Triangle>(in, static_cast<std::size_t>(counts[1]));
    mesh = test::welded(mesh);
  }
  return meshes;
}

void judge_all(const FieldSet& set, const std::filesystem::path& folder) {
  const auto meshes =
      folder.empty() ? std::vector<IndexedMesh>{} : read_meshes(folder / (set.name + ".skimage"), set.fields);
  if (!folder.empty() && meshes.empty()) return write_fields(folder, set);
  judge(set, "Geosis", [](const ScalarField& field, int) { return ours(field); });
#ifdef GEOSIS_HAS_VTK
  judge(set, "vtkFlyingEdges3D", [](const ScalarField& field, int) { return vtk_flying_edges(field, 0); });
  judge(set, "vtkMarchingCubes", [](const ScalarField& field, int) { return vtk_marching_cubes(field, 0); });
#endif
  if (folder.empty()) return;
  judge(set, "skimage (Lewiner)", [&](const ScalarField&, int n) { return meshes[static_cast<std::size_t>(n)]; });
}

}  // namespace
}  // namespace geosis::bench

int main(int count, char** arguments) {
  const std::filesystem::path folder = count > 1 ? arguments[1] : "";
  std::printf("| fields | program | right topology | manifold |\n|---|---|---|---|\n");
  for (const auto& set : geosis::bench::field_sets()) {
    if (count < 3 || set.name == arguments[2]) geosis::bench::judge_all(set, folder);
  }
}
