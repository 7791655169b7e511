#include "tests/property/surface_laws.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "engine/codec/level_codec.h"
#include "engine/volume/brick_file.h"
#include "tests/support/body_oracle.h"
#include "tests/support/supersampling.h"

namespace geosis::test {
namespace {

bool has_missing(const ScalarField& field) {
  return std::any_of(field.samples.begin(), field.samples.end(), [](float f) { return std::isnan(f); });
}

template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

std::string compare(const MeshCensus& found, const SurfaceTopology& expected, bool components) {
  if (found.euler() != expected.euler || (components && found.components != expected.components))
    return sentence("expected euler ", expected.euler, ", components ", expected.components, "; found ", found);
  return {};
}

Result<IndexedMesh> encoded_and_decoded(const IndexedMesh& mesh, GridShape shape) {
  const std::int32_t longest = std::max({shape.inlines, shape.crosslines, shape.samples});
  const auto part = static_cast<std::int32_t>(mesh.triangles.size() / 3 + 1);
  auto level = encode_level(mesh, {}, {.position_bits = position_bits_for(longest), .max_part_triangles = part});
  if (!level) return level.error();
  std::vector<std::span<const std::byte>> parts;
  for (const EncodedPart& encoded : level->parts) parts.emplace_back(encoded.bytes);
  auto decoded = decode_level(parts);
  if (!decoded) return std::move(decoded).error();
  return std::move(decoded->mesh);
}

}  // namespace

IndexedMesh extract_surface(const ScalarField& field, IsoRange range, BodyMode mode, bool cap, int threads) {
  const auto volume = make_bricked_volume(field.shape, field.samples);
  NoProgress progress;
  auto mesh = extract_body(*volume, range, {.mode = mode, .cap = cap, .region = whole(field.shape), .threads = threads},
                           progress);
  if (mesh) return std::move(mesh).value();
  ADD_FAILURE() << name_of(mesh.error().code) << ": " << mesh.error().message;
  return {};
}

namespace {

Verdict judge_closed(const ScalarField& field, IsoRange range, BodyMode mode, Arithmetic arithmetic) {
  const MeshCensus found = census(extract_surface(field, range, mode));
  const SurfaceTopology expected = expected_surface(field, range, mode, arithmetic);
  if (!found.is_closed_manifold()) return {sentence("not closed and manifold: ", found), expected.decided};
  if (found.off_lattice > 0) return {sentence("off the lattice: ", found), expected.decided};
  // In a body thinner than what flat triangles miss of a trilinear cell, both sheets may cross: no sign to tell.
  if (found.triangles > 0 && found.volume <= 0 && supersampled_volume(field, range, mode, 4) > 1)
    return {sentence("turned inside out: ", found), expected.decided};
  if (found.repeated_positions > 0 && !has_missing(field))
    return {sentence("vertices share a position: ", found), expected.decided};
  if (!expected.decided) return {{}, false};
  return {compare(found, expected, true), true};
}

Verdict judge_open(const ScalarField& field, IsoRange range, BodyMode mode, Arithmetic arithmetic) {
  const MeshCensus found = census(extract_surface(field, range, mode, false));
  const SurfaceTopology expected = expected_open_surface(field, range, mode, arithmetic);
  if (!found.is_manifold()) return {sentence("not manifold: ", found), expected.decided};
  if (found.off_lattice > 0) return {sentence("off the lattice: ", found), expected.decided};
  if (!expected.decided) return {{}, false};
  return {compare(found, expected, false), true};
}

}  // namespace

Verdict judge_closed_surface(const ScalarField& field, IsoRange range, BodyMode mode) {
  return judge_closed(field, range, mode, Arithmetic::rounded);
}

Verdict judge_open_surface(const ScalarField& field, IsoRange range, BodyMode mode) {
  return judge_open(field, range, mode, Arithmetic::rounded);
}

Verdict judge_closed_surface_exactly(const ScalarField& field, IsoRange range, BodyMode mode) {
  return judge_closed(field, range, mode, Arithmetic::exact);
}

Verdict judge_open_surface_exactly(const ScalarField& field, IsoRange range, BodyMode mode) {
  return judge_open(field, range, mode, Arithmetic::exact);
}

Verdict judge_decoded_surface(const ScalarField& field, IsoRange range, BodyMode mode) {
  const IndexedMesh mesh = extract_surface(field, range, mode);
  if (mesh.triangles.empty()) return {};
  const auto decoded = encoded_and_decoded(mesh, field.shape);
  if (!decoded) return {decoded.error().message};
  const MeshCensus before = census(mesh), after = census(*decoded);
  if (!after.is_closed_manifold()) return {sentence("decoded mesh is not closed and manifold: ", after)};
  const bool same = before.triangles == after.triangles && before.vertices == after.vertices &&
                    before.components == after.components &&
                    std::abs(before.volume - after.volume) <= 1e-9 * before.volume &&
                    before.repeated_positions == after.repeated_positions;
  if (!same) return {sentence("encoded ", before, "; decoded ", after)};
  return {};
}

Verdict judge_threads(const ScalarField& field, IsoRange range, BodyMode mode) {
  const IndexedMesh one = extract_surface(field, range, mode, true, 1);
  for (const int threads : {2, 3}) {
    const IndexedMesh several = extract_surface(field, range, mode, true, threads);
    if (one.positions != several.positions || one.triangles != several.triangles)
      return {sentence("1 thread gives ", census(one), "; ", threads, " threads give ", census(several))};
  }
  return {};
}

}  // namespace geosis::test
