#include "engine/simplify/fold_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lattice_triangles.h"

namespace geosis {
namespace {

/// Lattice steps from the star's vertex: whole numbers, so that up to 2^16 steps all products below are exact.
using Steps = Vec3d;

/// A corner's identity beside its place: what two triangles share they share by vertex.
struct Corner {
  LocalVertex id;
  Steps at;
};
using Corners = std::array<Corner, 3>;

struct Bounds {
  Steps low, high;

  Bounds() = default;
  explicit Bounds(const Corners& t) : low(t[0].at), high(t[0].at) {
    for (const Corner& corner : t) {
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], corner.at[axis]);
        high[axis] = std::max(high[axis], corner.at[axis]);
      }
    }
  }
  bool meet(const Bounds& other) const {
    bool meet = true;
    for (int axis = 0; axis < 3; ++axis) meet = meet && low[axis] <= other.high[axis] && other.low[axis] <= high[axis];
    return meet;
  }
};

bool strictly_same_side(double a, double b) {
  return (a > 0 && b > 0) || (a < 0 && b < 0);
}

LatticeTriangle on_lattice(const Corners& t) {
  LatticeTriangle result;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) result[k][axis] = static_cast<std::int64_t>(t[k].at[axis]);
  }
  return result;
}

Steps normal_of(const Corners& t) {
  return cross(t[1].at - t[0].at, t[2].at - t[0].at);
}

/// The star's triangles once moved: corner 0 of each is the star's vertex, the origin.
class PlacedStar {
 public:
  PlacedStar(const MergedStar& star, LocalVertex u, Vec3f position, std::span<const WorkingVertex> vertices)
      : position_(position), vertices_(vertices), degree_(star.degree) {
    for (int i = 0; i < degree_; ++i) {
      const auto [a, b] = star.ring[i];
      triangles_[i] = {{{u, {}}, corner(a), corner(b)}};
      normals_[i] = cross(triangles_[i][1].at, triangles_[i][2].at);
      bounds_[i] = Bounds(triangles_[i]);
    }
  }

  Corner corner(LocalVertex v) const {
    return {v, to_double(vertices_[v].position - position_) * kLatticeStepsPerVoxel};
  }

  bool meets_itself() const {
    for (int i = 0; i < degree_; ++i) {
      for (int k = i + 1; k < degree_; ++k) {
        if (triangles_meet(i, k)) return true;
      }
    }
    return false;
  }

  /// other   without the star's vertex.
  bool meets(const Corners& other) const {
    const Steps normal = normal_of(other);
    const Bounds bounds(other);
    for (int i = 0; i < degree_; ++i) {
      if (bounds_[i].meet(bounds) && meets(i, other, normal)) return true;
    }
    return false;
  }

 private:
  /// Two triangles on one edge meet beyond it only when they lie in one plane, folded onto each other.
  bool is_folded(int i, Steps normal, const Corner& third) const {
    return dot(normals_[i], normal) < 0 && dot(normals_[i], third.at) == 0;
  }

  bool triangles_meet(int i, int k) const {
    const auto& [centre, a, b] = triangles_[i];
    const auto& [same, c, d] = triangles_[k];
    if (c.id == b.id) return is_folded(i, normals_[k], d);
    if (d.id == a.id) return is_folded(i, normals_[k], c);
    if (strictly_same_side(dot(normals_[i], c.at), dot(normals_[i], d.at))) return false;
    if (strictly_same_side(dot(normals_[k], a.at), dot(normals_[k], b.at))) return false;
    return triangles_intersect(on_lattice(triangles_[i]), on_lattice(triangles_[k]));
  }

  bool meets(int i, const Corners& other, Steps normal) const {
    const auto& [centre, a, b] = triangles_[i];
    const Corner* apart[3];  // other's corners that are not the star triangle's
    int count = 0;
    for (const Corner& corner : other) {
      apart[count] = &corner;
      count += corner.id != a.id && corner.id != b.id;
    }
    if (count == 1) return is_folded(i, normal, *apart[0]);
    // What they share lies in both planes, so only the other corners tell.
    bool above = true, below = true;
    for (int k = 0; k < count; ++k) {
      const double side = dot(normals_[i], apart[k]->at);
      above &= side > 0;
      below &= side < 0;
    }
    if (above || below) return false;
    return triangles_intersect(on_lattice(triangles_[i]), on_lattice(other));
  }

  Vec3f position_;
  std::span<const WorkingVertex> vertices_;
  int degree_;
  std::array<Corners, kMaxMergedDegree> triangles_;
  std::array<Steps, kMaxMergedDegree> normals_;
  std::array<Bounds, kMaxMergedDegree> bounds_;
};

/// Whether all of a closed star, its vertex at `centre`, lies strictly on one side of the triangle's plane, but for the
/// corners that both have. False also where float32 cannot tell.
///
/// in_common   how many corners both have.
bool star_is_on_one_side(const MergedStar& star, const StarShape& shape, Vec3f centre, const std::array<Vec3f, 3>& t,
                         int in_common) {
  constexpr float kRounding = 1e-6f;  // several times that of a dot product
  const Vec3f normal = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3<Float4> n = all4(normal), origin = all4(t[0]);
  Mask4 above{}, below{}, on{};
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const Mask4 inside = lanes_below(first, star.degree);
    const Vec3<Float4> arm = Vec3<Float4>(shape.a[group]) - origin;
    const Float4 x = n.x * arm.x, y = n.y * arm.y, z = n.z * arm.z;
    const Float4 side = x + y + z;
    const Float4 unsure = (magnitude(x) + magnitude(y) + magnitude(z)) * kRounding;
    above |= inside & (side > unsure);
    below |= inside & (side < -unsure);
    on -= inside & (magnitude(side) <= unsure);
  }
  if (on[0] + on[1] + on[2] + on[3] != in_common) return false;
  const Vec3f arm = centre - t[0];
  const float side = dot(normal, arm);
  const float unsure =
      kRounding * (std::abs(normal.x * arm.x) + std::abs(normal.y * arm.y) + std::abs(normal.z * arm.z));
  return any(above) ? !any(below) && side > unsure : side < -unsure;
}

}  // namespace

bool folds_over(const MergedStar& star, const StarShape& shape, LocalVertex u, LocalVertex v, Vec3f position,
                std::span<const WorkingVertex> vertices, const Rings& rings, VertexMarks& marks) {
  const bool is_closed = !vertices[u].on_boundary && !vertices[v].on_boundary;
  const PlacedStar placed(star, u, position, vertices);
  if (placed.meets_itself()) return true;
  marks.clear();
  for (const auto [a, b] : star.triangles()) {
    marks.set(a);
    marks.set(b);
  }
  for (const RingTriangle in_star : star.triangles()) {
    const LocalVertex w = in_star.a;
    for (const auto [a, b] : rings.of(w)) {
      if (a == u || b == u || a == v || b == v) continue;
      if ((marks.has(a) && a < w) || (marks.has(b) && b < w)) continue;  // seen from that one
      const std::array<Vec3f, 3> corners{vertices[w].position, vertices[a].position, vertices[b].position};
      const int in_common = 1 + marks.has(a) + marks.has(b);
      if (is_closed && star_is_on_one_side(star, shape, position, corners, in_common)) continue;
      if (placed.meets({{placed.corner(w), placed.corner(a), placed.corner(b)}})) return true;
    }
  }
  return false;
}

}  // namespace geosis
