#include "engine/codec/level_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "engine/base/parallel.h"
#include "engine/codec/check_level.h"
#include "engine/codec/cut_parts.h"
#include "engine/codec/draco_part.h"
#include "engine/codec/join_parts.h"

namespace geosis {
namespace {

/// make_part(0) ... make_part(count - 1) in parallel, in order; the first part's error if one fails.
template <class Part, class MakePart>
Result<std::vector<Part>> make_parts(std::size_t count, int threads, const Progress& progress,
                                     const MakePart& make_part) {
  std::vector<std::optional<Result<Part>>> made(count);
  parallel_for(count, threads, [&](std::size_t part) {
    if (progress.cancelled()) {
      made[part] = Error{ErrorCode::cancelled, "the encoding or decoding of a level was cancelled"};
    } else {
      made[part] = make_part(part);
    }
  });
  std::vector<Part> parts;
  parts.reserve(count);
  for (std::size_t part = 0; part < count; ++part) {
    if (!*made[part]) {
      const Error& error = made[part]->error();
      if (error.code == ErrorCode::cancelled) return error;
      return Error{error.code, "part " + std::to_string(part) + ": " + error.message};
    }
    parts.push_back(*std::move(*made[part]));
  }
  return parts;
}

}  // namespace

int position_bits_for(std::int32_t longest_axis_samples) {
  const std::int64_t last_node = std::int64_t{longest_axis_samples} - 1;
  return last_node < 1
             ? 1
             : static_cast<int>(std::bit_width(static_cast<std::uint64_t>(last_node * kLatticeStepsPerVoxel)));
}

int position_bits_for(const IndexedMesh& mesh) {
  float longest = 0;
  for (const Vec3f& p : mesh.positions) longest = std::max({longest, p.x, p.y, p.z});
  return position_bits_for(static_cast<std::int32_t>(std::ceil(longest)) + 1);
}

Result<EncodedLevel> encode_level(const IndexedMesh& mesh, const VertexAttributes& attributes,
                                  const EncodeOptions& options, const Progress& progress) {
  if (auto encodable = check_level(mesh, attributes, options); !encodable) return encodable.error();
  const PartPlan plan = plan_parts(mesh, options.max_part_triangles);
  auto parts = make_parts<EncodedPart>(plan.parts(), options.threads, progress, [&](std::size_t part) {
    return encode_part(cut_part(mesh, attributes, plan, part), options);
  });
  if (!parts) return std::move(parts).error();
  return EncodedLevel{*std::move(parts)};
}

Result<DecodedLevel> decode_level(const std::vector<std::span<const std::byte>>& parts, int threads,
                                  const Progress& progress) {
  if (parts.empty()) return Error{ErrorCode::malformed_input, "a level without parts"};
  auto decoded =
      make_parts<MeshPart>(parts.size(), threads, progress, [&](std::size_t part) { return decode_part(parts[part]); });
  if (!decoded) return std::move(decoded).error();
  return join_parts(*std::move(decoded), progress);
}

}  // namespace geosis
