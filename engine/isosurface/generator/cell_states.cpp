#include "engine/isosurface/generator/cell_states.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/cell_decisions.h"
#include "engine/isosurface/generator/cell_loops.h"
#include "engine/isosurface/generator/random.h"

namespace geosis::generator {
namespace {

constexpr std::size_t kWitnesses = 12;
constexpr int kFieldsPerMask = 400'000;

using Permutation = std::array<int, 8>;

std::vector<Permutation> cube_symmetries() {
  std::vector<Permutation> all;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int flips = 0; flips < 8; ++flips) {
      Permutation p{};
      for (int c = 0; c < 8; ++c) {
        int image = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const bool bit = ((c & cell::corner_bit(axis)) != 0) != (((flips >> axis) & 1) != 0);
          if (bit) image |= cell::corner_bit(axes[axis]);
        }
        p[c] = image;
      }
      all.push_back(p);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

struct Classified {
  CellState state;
  std::array<int, 2> joint{};
};

Classified classify_with_joint(const Field& field) {
  Classified result;
  for (int c = 0; c < 8; ++c)
    result.state.above = static_cast<std::uint8_t>(result.state.above | ((field[c] > 0) << c));
  const CellValues cell{.value = field, .level = 0, .ties_above = true};
  const std::uint8_t above = result.state.above;
  result.state.joined_faces = joined_faces(cell, above, cell::ambiguous_faces(above));
  const InteriorJoint joint = interior_joint(cell, above);
  if (!joint.joined) return result;
  const auto region = trace_loops(above, result.state.joined_faces).region;
  if (region[joint.first] == region[joint.second]) return result;
  result.state.tunnel = joint.above ? Tunnel::above : Tunnel::below;
  result.joint = {std::min(region[joint.first], region[joint.second]),
                  std::max(region[joint.first], region[joint.second])};
  return result;
}

/// One mask of each orbit under symmetry and complement: the smallest.
std::vector<std::uint8_t> representative_masks(const std::vector<Permutation>& symmetries) {
  std::vector<std::uint8_t> representatives;
  for (int mask = 1; mask < 255; ++mask) {
    int smallest = 255;
    for (const auto& p : symmetries) {
      int image = 0;
      for (int c = 0; c < 8; ++c) image |= ((mask >> c) & 1) << p[c];
      smallest = std::min({smallest, image, 255 - image});
    }
    if (smallest == mask) representatives.push_back(static_cast<std::uint8_t>(mask));
  }
  return representatives;
}

Field random_field(std::uint8_t mask, Random& random) {
  Field field{};
  const bool wide = random.unit() < 0.5;  // magnitudes over a decade or over several
  for (int c = 0; c < 8; ++c) {
    const double u = random.unit();
    const double magnitude = wide ? u * u * u : u;
    field[c] = ((mask >> c) & 1) ? magnitude : -magnitude;
  }
  return field;
}

void record(std::map<CellState, StateWitnesses>& states, const Field& field) {
  const Classified found = classify_with_joint(field);
  StateWitnesses& witnesses = states[found.state];
  if (witnesses.fields.empty()) {
    witnesses.joint = found.joint;
  } else if (witnesses.joint != found.joint) {
    std::fprintf(stderr, "mask %d: the same state joins different regions\n", found.state.above);
    std::exit(1);
  }
  if (witnesses.fields.size() < kWitnesses) witnesses.fields.push_back(field);
}

void record_images(std::map<CellState, StateWitnesses>& states, const Field& field,
                   const std::vector<Permutation>& symmetries) {
  for (const auto& p : symmetries) {
    for (double sign : {1.0, -1.0}) {
      Field image{};
      for (int c = 0; c < 8; ++c) image[p[c]] = sign * field[c];
      record(states, image);
    }
  }
}

}  // namespace

CellState classify(const Field& field) {
  return classify_with_joint(field).state;
}

std::map<CellState, StateWitnesses> enumerate_states() {
  const auto symmetries = cube_symmetries();
  std::map<CellState, StateWitnesses> states;
  for (std::uint8_t mask : representative_masks(symmetries)) {
    Random random(mask);
    const int fields = cell::ambiguous_faces(mask) != 0 || mask == 0x81 ? kFieldsPerMask : static_cast<int>(kWitnesses);
    for (int n = 0; n < fields; ++n) {
      const Field field = random_field(mask, random);
      const auto known = states.find(classify(field));
      if (known == states.end() || known->second.fields.size() < kWitnesses) record_images(states, field, symmetries);
    }
  }
  return states;
}

}  // namespace geosis::generator
