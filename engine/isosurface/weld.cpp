#include "engine/isosurface/weld.h"

#include <atomic>
#include <limits>
#include <string>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr std::int32_t kOwn = -1;

/// Numbers of one brick's vertices in the welded mesh.
struct BrickNumbers {
  std::vector<std::int32_t> number;  ///< brick's vertex -> welded vertex
  std::int64_t own = 0;              ///< vertices that belong to this brick
};

class Welder {
 public:
  Welder(const BrickLayout& layout, const std::vector<std::size_t>& bricks, std::vector<BrickMesh> meshes, int threads)
      : layout_(layout), bricks_(bricks), meshes_(std::move(meshes)), threads_(threads), numbers_(bricks.size()) {
    slot_.assign(layout.brick_count(), kOwn);
    for (std::size_t n = 0; n < bricks.size(); ++n) slot_[bricks[n]] = static_cast<std::int32_t>(n);
  }

  Result<IndexedMesh> weld(std::int64_t max_triangles) {
    each_brick([&](std::size_t n) { count_own(n); });
    if (auto counted = lay_out(max_triangles); !counted) return std::move(counted).error();
    each_brick([&](std::size_t n) { number_own(n); });
    // A vertex on several upper layers is taken from the next brick along the first of these axes; there it lies on the
    // remaining ones only, so going from the last axis to the first finds every number settled.
    for (int axis = 2; axis >= 0; --axis) each_brick([&](std::size_t n) { number_upper_layer(n, axis); });
    if (inconsistent_) {
      return Error{ErrorCode::malformed_input,
                   "bricks disagree on a layer that they share: the volume's index is damaged"};
    }
    each_brick([&](std::size_t n) { copy(n); });
    return std::move(welded_);
  }

 private:
  template <class Task>
  void each_brick(const Task& task) {
    parallel_for(bricks_.size(), threads_, task);
  }

  /// First axis on whose upper layer the vertex lies; kOwn for the brick's own vertices.
  std::vector<std::int32_t> owner_axes(const BrickMesh& mesh) const {
    std::vector<std::int32_t> axes(mesh.positions.size(), kOwn);
    for (int axis = 2; axis >= 0; --axis) {
      for (std::int32_t v : mesh.upper_layer[axis]) axes[v] = axis;
    }
    return axes;
  }

  void count_own(std::size_t n) {
    for (std::int32_t axis : numbers_[n].number = owner_axes(meshes_[n])) numbers_[n].own += axis == kOwn;
  }

  Result<void> lay_out(std::int64_t max_triangles) {
    std::int64_t vertices = 0, triangles = 0;
    for (std::size_t n = 0; n < bricks_.size(); ++n) {
      first_vertex_.push_back(vertices);
      first_triangle_.push_back(triangles);
      vertices += numbers_[n].own;
      triangles += static_cast<std::int64_t>(meshes_[n].triangles.size());
    }
    if (triangles > max_triangles || vertices > std::numeric_limits<std::int32_t>::max()) {
      return Error{ErrorCode::limit_exceeded, "surface has " + std::to_string(triangles) + " triangles, the limit is " +
                                                  std::to_string(max_triangles)};
    }
    welded_.positions.resize(static_cast<std::size_t>(vertices));
    welded_.triangles.resize(static_cast<std::size_t>(triangles));
    return {};
  }

  void number_own(std::size_t n) {
    std::int64_t next = first_vertex_[n];
    for (std::int32_t& v : numbers_[n].number) {
      const bool own = v == kOwn;
      v = own ? static_cast<std::int32_t>(next++) : -2 - v;  // -2, -3, -4: to be taken from the next along axis 0, 1, 2
    }
  }

  void number_upper_layer(std::size_t n, int axis) {
    const auto& layer = meshes_[n].upper_layer[axis];
    if (layer.empty()) return;
    GridIndex place = layout_.place(bricks_[n]);
    ++place[axis];
    const std::int32_t next = slot_[layout_.number(place)];
    if (next == kOwn || meshes_[next].lower_layer[axis].size() != layer.size()) {
      inconsistent_ = true;
      return;
    }
    const auto& theirs = meshes_[next].lower_layer[axis];
    for (std::size_t k = 0; k < layer.size(); ++k) {
      std::int32_t& number = numbers_[n].number[layer[k]];
      if (number == -2 - axis) number = numbers_[next].number[theirs[k]];
    }
  }

  void copy(std::size_t n) {
    const auto& number = numbers_[n].number;
    BrickMesh mesh = std::move(meshes_[n]);
    const std::int64_t first = first_vertex_[n], end = first + numbers_[n].own;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (number[v] >= first && number[v] < end) welded_.positions[number[v]] = mesh.positions[v];
    }
    Triangle* out = welded_.triangles.data() + first_triangle_[n];
    for (const Triangle& t : mesh.triangles) *out++ = {number[t[0]], number[t[1]], number[t[2]]};
  }

  const BrickLayout& layout_;
  const std::vector<std::size_t>& bricks_;
  std::vector<BrickMesh> meshes_;
  const int threads_;
  std::vector<BrickNumbers> numbers_;
  std::vector<std::int32_t> slot_;  ///< brick number -> place in bricks_
  std::vector<std::int64_t> first_vertex_, first_triangle_;
  std::atomic<bool> inconsistent_{false};
  IndexedMesh welded_;
};

}  // namespace

Result<IndexedMesh> weld_bricks(const BrickLayout& layout, const std::vector<std::size_t>& bricks,
                                std::vector<BrickMesh> meshes, std::int64_t max_triangles, int threads) {
  return Welder(layout, bricks, std::move(meshes), threads).weld(max_triangles);
}

}  // namespace geosis
