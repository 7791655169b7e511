#include "engine/pipeline/level_attributes.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/missing/reliability_at.h"
#include "engine/pipeline/level_normals.h"
#include "engine/volume/sample_at.h"

namespace geosis {
namespace {

std::vector<std::uint32_t> bodies_of(std::span<const std::int32_t> origin, std::span<const std::uint32_t> body_of_m0) {
  if (body_of_m0.empty() || origin.empty()) return {body_of_m0.begin(), body_of_m0.end()};
  std::vector<std::uint32_t> bodies;
  bodies.reserve(origin.size());
  for (const std::int32_t vertex : origin) bodies.push_back(body_of_m0[static_cast<std::size_t>(vertex)]);
  return bodies;
}

/// Where the samples are that count at each vertex; empty when the vertices are there themselves.
std::vector<Vec3f> moved_to_samples(const IndexedMesh& mesh, std::span<const std::int32_t> origin,
                                    const AttributeSources& sources) {
  if (sources.rectified != nullptr) return to_samples(*sources.rectified, mesh.positions, sources.threads);
  if (sources.places.empty() || origin.empty()) return {sources.places.begin(), sources.places.end()};
  std::vector<Vec3f> places;
  places.reserve(origin.size());
  for (const std::int32_t vertex : origin) places.push_back(sources.places[static_cast<std::size_t>(vertex)]);
  return places;
}

}  // namespace

Result<VertexAttributes> attributes_of(const IndexedMesh& mesh, std::span<const std::int32_t> origin,
                                       const AttributeSources& sources, const Progress& progress) {
  VertexAttributes attributes;
  attributes.body = bodies_of(origin, sources.body);
  const std::vector<Vec3f> at_samples = moved_to_samples(mesh, origin, sources);
  const std::vector<Vec3f>& positions = at_samples.empty() ? mesh.positions : at_samples;
  if (sources.filled != nullptr) {
    auto reliability = reliability_at(*sources.filled, positions, sources.threads, progress);
    if (!reliability) return std::move(reliability).error();
    attributes.reliability = *std::move(reliability);
  }
  if (sources.flat_normals) {
    attributes.normal = normals_of_triangles(mesh);
  } else if (sources.normals != nullptr) {
    auto normals =
        normals_of(mesh, *sources.normals, sources.normals_first, sources.mirrored, sources.threads, progress);
    if (!normals) return std::move(normals).error();
    attributes.normal = *std::move(normals);
  }
  if (sources.agreement != nullptr) {
    attributes.agreement = agreement_at(*sources.agreement, positions, sources.threads);
  }
  if (sources.value != nullptr) {
    auto values = sample_at(*sources.value, positions, sources.threads, progress);
    if (!values) return std::move(values).error();
    attributes.value = *std::move(values);
  }
  return attributes;
}

double interpolated_share(std::span<const std::uint8_t> reliability) {
  if (reliability.empty()) return 0;
  const auto interpolated =
      std::count_if(reliability.begin(), reliability.end(), [](std::uint8_t r) { return r < 255; });
  return static_cast<double>(interpolated) / static_cast<double>(reliability.size());
}

}  // namespace geosis
