#include "engine/isosurface/generator/cell_geometries.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/generator/random.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis::generator {
namespace {

constexpr int kStepsFromAWitness = 50;
constexpr int kTriesPerGeometry = 200;
constexpr double kSmallest = 1e-9;

/// A factor between 1 / (1 + reach) and 1 + reach.
double random_factor(Random& random, double reach) {
  const double factor = 1 + reach * random.unit();
  return random.unit() < 0.5 ? factor : 1 / factor;
}

/// All corners changed, or one in two, by little or by much.
Field changed(Field field, Random& random) {
  const double amount = random.unit(), share = random.unit();
  const double reach = amount < 0.4 ? 0.3 : amount < 0.7 ? 2 : 20;
  for (double& value : field) {
    if (share < 0.5 || random.unit() < 0.5) value *= random_factor(random, reach);
  }
  double largest = 0;
  for (double value : field) largest = std::max(largest, std::fabs(value));
  for (double& value : field) value /= largest;
  return field;
}

bool is_degenerate(const Field& field) {
  return std::any_of(field.begin(), field.end(), [](double value) { return std::fabs(value) < kSmallest; });
}

CellPoints lattice_points(const Field& field) {
  CellPoints points{};
  for (int e = 0; e < cell::kEdges; ++e) {
    const int a = cell::edge_start(e), b = cell::edge_end(e);
    if ((field[a] > 0) == (field[b] > 0)) continue;
    const double t = field[a] / (field[a] - field[b]);
    const double step = std::floor(t * kLatticeStepsPerVoxel + 0.5);
    points[e] = LatticePoint{(a >> 2) & 1, (a >> 1) & 1, a & 1} * kLatticeStepsPerVoxel;
    points[e][cell::edge_axis(e)] += static_cast<std::int64_t>(std::clamp(step, 1.0, kLatticeStepsPerVoxel - 1.0));
  }
  return points;
}

/// The points as one ordered key.
std::array<std::int64_t, cell::kEdges> key_of(const CellPoints& points) {
  std::array<std::int64_t, cell::kEdges> key{};
  for (int e = 0; e < cell::kEdges; ++e) key[e] = points[e][cell::edge_axis(e)];
  return key;
}

}  // namespace

std::vector<CellPoints> sample_geometries(const CellState& state, const StateWitnesses& witnesses, int count,
                                          std::uint64_t seed) {
  Random random(seed);
  std::vector<CellPoints> geometries;
  std::set<std::array<std::int64_t, cell::kEdges>> known;
  Field field{};
  std::size_t witness = 0;
  int steps = 0;
  for (int tries = 0; tries < kTriesPerGeometry * count && static_cast<int>(geometries.size()) < count; ++tries) {
    if (steps++ % kStepsFromAWitness == 0) field = witnesses.fields[witness++ % witnesses.fields.size()];
    const Field next = changed(field, random);
    if (is_degenerate(next) || classify(next) != state) continue;
    field = next;
    const CellPoints points = lattice_points(field);
    if (known.insert(key_of(points)).second) geometries.push_back(points);
  }
  return geometries;
}

}  // namespace geosis::generator
