#include "engine/isosurface/generator/write_report.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include "engine/isosurface/generator/case_names.h"

namespace geosis::generator {
namespace {

struct SubcaseCounts {
  std::set<int> masks;
  int states = 0, patches = 0, inner = 0;
  std::size_t fewest = 99, most = 0;  ///< triangles of a patch
  long geometries = 0, first_cuts = 0, inner_serves = 0, all_cut = 0;

  void add(const CellState& state, const ProvenState& proven) {
    masks.insert(state.above);
    ++states;
    patches += static_cast<int>(proven.patches.size());
    for (const TunnelCandidate& patch : proven.patches) {
      inner += patch.inner.has_inner_vertex();
      fewest = std::min(fewest, patch.triangles.size());
      most = std::max(most, patch.triangles.size());
    }
    geometries += proven.geometries;
    first_cuts += proven.first_cuts;
    inner_serves += proven.inner_serves;
    all_cut += proven.all_cut;
  }
};

void print_row(const std::string& name, const SubcaseCounts& counts, std::ostream& out) {
  out << "| " << name << " | " << counts.states << " | " << counts.masks.size() << " | " << counts.patches << " | "
      << counts.inner << " | " << counts.fewest;
  if (counts.most != counts.fewest) out << " to " << counts.most;
  out << " | " << counts.geometries << " | " << counts.first_cuts << " | " << counts.inner_serves << " | "
      << counts.all_cut << " |\n";
}

void print_masks(const std::string& name, const std::set<int>& masks, std::ostream& out) {
  out << "- **" << name << "**:";
  for (int mask : masks) out << ' ' << mask;
  out << '\n';
}

constexpr const char* kIntroduction =
    R"(# The cases of a cell

Written by `engine/isosurface/generator` together with `engine/isosurface/mc33_tables.cpp`: do not edit; a test writes both
again and compares.

A state is a sign mask (bit c: corner c lies above the level; corner c = 4 di + 2 dj + dk), the decisions of its
ambiguous faces, and whether the interior joins two regions above or below the level by a tunnel. The generator finds every
state that a trilinear function can take and names it as Chernyaev does ("Marching Cubes 33", 1995). Of mirror images
with two names, 11 is the path of corners that turns like a right-handed frame and 14 the other; 12.2 and 12.3 likewise
differ by which of two faces is joined: there the choice of name is ours.

Proven of every patch: its boundary is exactly the loops on the cell's surface, every other edge has two triangles of
opposite direction, its Euler characteristic is that of its discs and annulus, and no chord in a face is one that the
neighbouring cell may draw.

Checked in sampled functions of each state, crossings rounded and clamped to the lattice of 1/64 as in the mesh, by
exact integers: whether two triangles of the patch meet outside the corners and edges they share. States with a tunnel have
several patches, and the mesher takes the first that does not cut itself.

)";

constexpr const char* kColumns =
    "| subcase | states | sign masks | patches | with a vertex inside | triangles | geometries | first patch cuts "
    "itself | "
    "needs the vertex inside | all cut themselves |\n|---|---|---|---|---|---|---|---|---|---|\n";

}  // namespace

std::string report_text(const std::map<CellState, ProvenState>& states) {
  std::map<std::string, SubcaseCounts> counts;
  SubcaseCounts all;
  int with_inner = 0;
  for (const auto& [state, proven] : states) {
    counts[subcase_of(state)].add(state, proven);
    all.add(state, proven);
    with_inner += std::any_of(proven.patches.begin(), proven.patches.end(),
                              [](const TunnelCandidate& patch) { return patch.inner.has_inner_vertex(); });
  }
  std::vector<std::string> names = subcase_names();
  names.erase(names.begin());  // 0, all corners on one side, has no surface
  std::ostringstream out;
  out << kIntroduction << kColumns;
  for (const auto& name : names) print_row(name, counts[name], out);
  print_row("all", all, out);
  out << "\n"
      << with_inner << " states have a patch with a vertex inside the cell.\n\n## Sign masks of each subcase\n\n";
  for (const auto& name : names) print_masks(name, counts[name].masks, out);
  return out.str();
}

}  // namespace geosis::generator
