#include "engine/codec/check_level.h"

#include <cmath>
#include <string>

#include "engine/codec/attribute_arrays.h"

namespace geosis {
namespace {

Error invalid(std::string message) {
  return {ErrorCode::invalid_argument, std::move(message)};
}

Result<void> check_options(const EncodeOptions& options) {
  if (options.position_bits < 1 || options.position_bits > kMaxPositionBits) {
    return invalid("position bits " + std::to_string(options.position_bits) + "; expected 1.." +
                   std::to_string(kMaxPositionBits));
  }
  if (options.speed < 0 || options.speed > 10) {
    return invalid("codec speed " + std::to_string(options.speed) + "; expected 0..10");
  }
  if (options.max_part_triangles < 1) {
    return invalid("at most " + std::to_string(options.max_part_triangles) + " triangles a part; expected 1 or more");
  }
  for (double entry : options.transform) {
    if (!std::isfinite(entry)) return invalid("the transform has the entry " + std::to_string(entry));
  }
  return {};
}

/// Steps are exact: the product with a power of two rounds nothing. NaN fails the comparison.
bool is_lattice_position(float position, float last_step) {
  const float steps = position * float{kLatticeStepsPerVoxel};
  return steps >= 0 && steps <= last_step && steps == std::trunc(steps);
}

Result<void> check_positions(const std::vector<Vec3f>& positions, int bits) {
  const auto last_step = static_cast<float>((1 << bits) - 1);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const float position = positions[v][axis];
      if (is_lattice_position(position, last_step)) continue;
      return invalid("vertex " + std::to_string(v) + ", axis " + std::to_string(axis) + ": position " +
                     std::to_string(position) + " is not a multiple of 1/64 from 0 to " +
                     std::to_string(last_step * kLatticeStep));
    }
  }
  return {};
}

Result<void> check_triangles(const std::vector<Triangle>& triangles, std::size_t vertices) {
  if (triangles.empty()) return invalid("a level without triangles cannot be encoded");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    for (const std::int32_t v : triangles[t]) {
      if (v >= 0 && static_cast<std::size_t>(v) < vertices) continue;
      return invalid("triangle " + std::to_string(t) + ": vertex " + std::to_string(v) + " of " +
                     std::to_string(vertices));
    }
    if (a == b || b == c || c == a) return invalid("triangle " + std::to_string(t) + " uses a vertex twice");
  }
  return {};
}

/// To within the rounding of float32; NaN fails the comparison.
bool is_unit(Vec3f normal) {
  return std::abs(dot(normal, normal) - 1) < 1e-3f;
}

Result<void> check_attributes(const VertexAttributes& attributes, std::size_t vertices) {
  auto fit = visit_arrays([&](const char* name, auto array) -> Result<void> {
    const std::size_t values = (attributes.*array).size();
    if (values == 0 || values == vertices) return {};
    return invalid(std::to_string(values) + " values of the attribute " + name + " for " + std::to_string(vertices) +
                   " vertices");
  });
  if (!fit) return fit;
  for (std::size_t v = 0; v < attributes.body.size(); ++v) {
    if (attributes.body[v] <= kMaxBody) continue;
    return invalid("vertex " + std::to_string(v) + ": body " + std::to_string(attributes.body[v]) + "; at most " +
                   std::to_string(kMaxBody));
  }
  for (std::size_t v = 0; v < attributes.normal.size(); ++v) {
    if (is_unit(attributes.normal[v])) continue;
    return invalid("vertex " + std::to_string(v) + ": the normal's length is " +
                   std::to_string(norm(attributes.normal[v])) + "; expected 1");
  }
  return {};
}

}  // namespace

Result<void> check_level(const IndexedMesh& mesh, const VertexAttributes& attributes, const EncodeOptions& options) {
  if (auto options_fit = check_options(options); !options_fit) return options_fit;
  if (auto on_lattice = check_positions(mesh.positions, options.position_bits); !on_lattice) return on_lattice;
  if (auto attributes_fit = check_attributes(attributes, mesh.positions.size()); !attributes_fit) return attributes_fit;
  return check_triangles(mesh.triangles, mesh.positions.size());
}

}  // namespace geosis
