// What levels of detail are worth: triangles, distance to M0, drift of the volume, components, intersecting pairs, and
// the CPU time they took; the peers beside them at equal counts.
//
// usage: level_quality [nodes an axis = 128] [peers = 1]
//
// Surfaces: a channel (a compact body), thin reflectors (a busy volume), a gyroid with noise.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include "engine/analysis/self_intersections.h"
#include "engine/analysis/surface_distance.h"
#include "engine/isosurface/extract.h"
#include "engine/mesh/components.h"
#include "engine/simplify/build_lods.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/engine/simplify/field_mesh.h"

#ifdef GEOSIS_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif
#ifdef GEOSIS_HAVE_CGAL
#include "bench/engine/simplify/garland_heckbert.h"
#endif

namespace geosis {
namespace {

constexpr double kRatios[] = {0.25, 0.0625, 0.015625, 0.00390625};

IndexedMesh survey_surface(SurveyKind kind, int nodes, IsoRange range) {
  const GridShape shape{nodes, nodes, nodes};
  const SyntheticSurvey survey({.shape = shape, .kind = kind, .polygon = false, .holes = false});
  std::vector<float> samples(static_cast<std::size_t>(shape.count()));
  const auto length = static_cast<std::size_t>(nodes);
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < nodes; ++j) {
      survey.fill_trace(i, j, std::span(samples).subspan(static_cast<std::size_t>(i * nodes + j) * length, length));
    }
  }
  NoProgress progress;
  auto mesh =
      extract_body(*make_bricked_volume(shape, samples), range, {.region = whole(shape), .threads = 2}, progress);
  return mesh ? *std::move(mesh) : IndexedMesh{};
}

IndexedMesh rough_gyroid(int nodes) {
  const NodeField smooth = gyroid(20, 0.2);
  const NodeField rough = noise(7);
  const std::array<int, 3> shape{nodes, nodes, nodes};
  return mesh_field(
      shape, closed_on_faces(shape, [&](int i, int j, int k) { return smooth(i, j, k) + 0.1 * rough(i, j, k); }));
}

double volume_of(const IndexedMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six += dot(to_double(mesh.positions[a]), cross(to_double(mesh.positions[b]), to_double(mesh.positions[c])));
  }
  return six / 6;
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// One surface and all that is measured against it.
class Report {
 public:
  Report(const char* name, const IndexedMesh& m0)
      : m0_(m0), reference_(m0, {.samples = 100'000, .threads = 2}), volume_(volume_of(m0)) {
    std::printf("\n%s: %zu triangles, %d components, %lld intersecting pairs\n", name, m0.triangles.size(),
                find_components(m0).count, static_cast<long long>(count_intersecting_pairs(m0, 2)));
    std::printf("  %-22s %9s %8s %8s %8s %9s %6s %6s\n", "", "triangles", "cpu s", "mean", "max", "volume %", "comps",
                "pairs");
  }

  /// on_lattice   pairs are decided exactly on the lattice, which peers leave.
  void add(const std::string& name, const IndexedMesh& level, double cpu, bool on_lattice) const {
    const SurfaceDistance distance = reference_.measure(level);
    const std::string pairs = on_lattice ? std::to_string(count_intersecting_pairs(level, 2)) : "-";
    std::printf("  %-22s %9zu %8.3f %8.4f %8.2f %9.3f %6d %6s\n", name.c_str(), level.triangles.size(), cpu,
                distance.mean_voxels, distance.max_voxels, 100 * (volume_of(level) - volume_) / volume_,
                find_components(level).count, pairs.c_str());
    std::fflush(stdout);
  }

  /// The whole chain; cpu is the chain's.
  std::vector<std::size_t> add_levels(const std::string& name, const BuildLodsOptions& options) const {
    NoProgress progress;
    const double start = cpu_seconds();
    const auto lods = build_lods(m0_, options, progress);
    const double cpu = cpu_seconds() - start;
    std::vector<std::size_t> counts;
    if (!lods) return counts;
    for (const LodLevel& level : lods->levels) {
      add(name, level.mesh, cpu, true);
      counts.push_back(level.mesh.triangles.size());
    }
    return counts;
  }

  void add_peers([[maybe_unused]] const std::vector<std::size_t>& counts) const {
#ifdef GEOSIS_HAVE_MESHOPTIMIZER
    const auto* first = reinterpret_cast<const unsigned*>(m0_.triangles.data());
    for (const std::size_t count : counts) {
      const double start = cpu_seconds();
      std::vector<unsigned> out(3 * m0_.triangles.size());
      out.resize(meshopt_simplify(out.data(), first, out.size(), &m0_.positions[0].x, m0_.positions.size(),
                                  sizeof(Vec3f), 3 * count, 1e9f, 0, nullptr));
      IndexedMesh level{m0_.positions, {}};
      for (std::size_t i = 0; i < out.size(); i += 3) {
        level.triangles.push_back({static_cast<std::int32_t>(out[i]), static_cast<std::int32_t>(out[i + 1]),
                                   static_cast<std::int32_t>(out[i + 2])});
      }
      add("meshoptimizer, alone", level, cpu_seconds() - start, true);
    }
#endif
#ifdef GEOSIS_HAVE_CGAL
    for (const std::size_t count : counts) {
      const double start = cpu_seconds();
      const double ratio = static_cast<double>(count) / static_cast<double>(m0_.triangles.size());
      const IndexedMesh level = garland_heckbert(m0_, ratio);
      add("CGAL Garland-Heckbert", level, cpu_seconds() - start, false);
    }
#endif
  }

 private:
  const IndexedMesh& m0_;
  ReferenceSurface reference_;
  double volume_;
};

void report(const char* name, const IndexedMesh& m0, bool peers) {
  const Report report(name, m0);
  const auto levels = by_ratio({std::begin(kRatios), std::end(kRatios)});
  const auto counts = report.add_levels("greedy", {.levels = levels});
  report.add_levels("multiple choice", {.levels = levels, .strategy = Strategy::multiple_choice});
  report.add_levels("greedy, subset", {.levels = levels, .placement = Placement::subset});
  if (peers) report.add_peers(counts);
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  using namespace geosis;
  const int nodes = argc > 1 ? std::atoi(argv[1]) : 128;
  const bool peers = argc <= 2 || std::atoi(argv[2]) != 0;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  report("channel", survey_surface(SurveyKind::channel, nodes, {0.55f, kInfinity}), peers);
  report("reflectors", survey_surface(SurveyKind::reflectors, nodes, {0.2f, kInfinity}), peers);
  report("rough gyroid", rough_gyroid(nodes / 2), peers);
  return 0;
}
