#include "engine/codec/join_parts.h"

#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "engine/codec/attribute_arrays.h"

namespace geosis {
namespace {

constexpr std::int32_t kNone = -1;

Error malformed(std::string message) {
  return {ErrorCode::malformed_input, std::move(message)};
}

/// What is known of one seam vertex while the parts are walked.
struct SeamVertex {
  std::int32_t vertex = kNone;      ///< in the joined mesh
  std::int32_t first_part = kNone;  ///< the part that brought it
  bool shared = false;              ///< seen in a second part
};

/// NaN equals itself, and 0 is not -0.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Adds a part's values to those joined before. place[v] is where the part's vertex v went: behind all others, or onto
/// a seam vertex, which must carry the same value.
///
/// returns  the first vertex that carries another value.
template <class T>
std::optional<std::size_t> join_values(const std::vector<T>& values, const std::vector<std::int32_t>& place,
                                       std::vector<T>& joined) {
  for (std::size_t v = 0; v < values.size(); ++v) {
    const auto at = static_cast<std::size_t>(place[v]);
    if (at == joined.size()) {
      joined.push_back(values[v]);
    } else if (!same_bits(joined[at], values[v])) {
      return v;
    }
  }
  return std::nullopt;
}

/// The joined level under construction.
class Joiner {
 public:
  explicit Joiner(std::size_t vertices) : largest_id_(vertices) { joined_.mesh.positions.reserve(vertices); }

  Result<void> add(const MeshPart& part, std::int32_t part_number) {
    const std::size_t known = joined_.mesh.positions.size();
    std::vector<std::int32_t> place(part.mesh.positions.size());
    for (std::size_t v = 0; v < place.size(); ++v) {
      auto vertex = place_vertex(part.mesh.positions[v], part.seams.empty() ? 0 : part.seams[v], part_number);
      if (!vertex) return std::move(vertex).error();
      place[v] = *vertex;
    }
    if (auto added = add_attributes(part, place, known, part_number); !added) return added;
    for (const auto& [a, b, c] : part.mesh.triangles) {
      const Triangle triangle = {place[a], place[b], place[c]};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
        return malformed("part " + std::to_string(part_number) + ": the seam collapses a triangle");
      }
      joined_.mesh.triangles.push_back(triangle);
    }
    return {};
  }

  Result<DecodedLevel> finish() && {
    for (std::size_t id = 1; id < seams_.size(); ++id) {
      if (seams_[id].vertex == kNone || seams_[id].shared) continue;
      return malformed("seam vertex " + std::to_string(id) + " is in part " + std::to_string(seams_[id].first_part) +
                       " only; a part is missing");
    }
    return std::move(joined_);
  }

 private:
  Result<std::int32_t> place_vertex(Vec3f position, std::uint32_t seam, std::int32_t part_number) {
    const auto next = static_cast<std::int32_t>(joined_.mesh.positions.size());
    if (seam == 0) {
      joined_.mesh.positions.push_back(position);
      return next;
    }
    if (seam > largest_id_) {
      return malformed("part " + std::to_string(part_number) + ": seam vertex " + std::to_string(seam) + " of " +
                       std::to_string(largest_id_) + " vertices");
    }
    if (seam >= seams_.size()) seams_.resize(seam + std::size_t{1});
    SeamVertex& known = seams_[seam];
    if (known.vertex == kNone) {
      known = {next, part_number, false};
      joined_.mesh.positions.push_back(position);
    } else if (!same_bits(joined_.mesh.positions[known.vertex], position)) {
      return malformed("parts " + std::to_string(known.first_part) + " and " + std::to_string(part_number) +
                       " disagree on the position of seam vertex " + std::to_string(seam));
    }
    known.shared |= known.first_part != part_number;
    return known.vertex;
  }

  /// known  vertices that were joined before this part.
  Result<void> add_attributes(const MeshPart& part, const std::vector<std::int32_t>& place, std::size_t known,
                              std::int32_t part_number) {
    return visit_arrays([&](const char* name, auto array) -> Result<void> {
      const auto& values = part.attributes.*array;
      auto& joined = joined_.attributes.*array;
      if (known > 0 && !place.empty() && values.empty() != joined.empty()) {
        return malformed("part " + std::to_string(part_number) + (values.empty() ? " lacks" : " alone has") +
                         " the attribute " + name);
      }
      const auto differs = join_values(values, place, joined);
      if (!differs) return {};
      return malformed("part " + std::to_string(part_number) + " disagrees on the " + name + " of seam vertex " +
                       std::to_string(part.seams[*differs]));
    });
  }

  std::size_t largest_id_;
  std::vector<SeamVertex> seams_;  ///< by id; grows with the largest id seen, at most to the number of vertices
  DecodedLevel joined_;
};

}  // namespace

Result<DecodedLevel> join_parts(std::vector<MeshPart> parts, const Progress& progress) {
  if (parts.size() == 1 && parts[0].seams.empty()) {
    return DecodedLevel{std::move(parts[0].mesh), std::move(parts[0].attributes)};
  }
  std::size_t vertices = 0;
  for (const MeshPart& part : parts) vertices += part.mesh.positions.size();
  if (vertices > std::numeric_limits<std::int32_t>::max()) {
    return malformed("the parts have " + std::to_string(vertices) + " vertices together; at most 2147483647");
  }
  Joiner joiner(vertices);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "the joining of a level's parts was cancelled"};
    if (auto added = joiner.add(parts[part], static_cast<std::int32_t>(part)); !added) return added.error();
    parts[part] = {};  // its memory is not needed any more
  }
  return std::move(joiner).finish();
}

}  // namespace geosis
