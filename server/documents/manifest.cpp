#include "server/documents/manifest.h"

#include "engine/base/digest.h"
#include "engine/pipeline/output_space.h"
#include "server/documents/grid_report.h"
#include "server/documents/ids.h"
#include "server/documents/request.h"
#include "server/documents/request_levels.h"

namespace geosis::server {
namespace {

/// The levels' positions to the requested space, row-major.
std::array<double, 16> output_transform(const VolumeSummary& volume, const ReconstructOptions& options,
                                        const Reconstruction& reconstruction) {
  if (options.grid == GridChoice::curvilinear || options.preview) return reconstruction.transform;
  return *output_space(volume.geometry, options)->affine();  // the geometry is affine: this cannot fail
}

Json chosen_grid_document(const ReconstructOptions& options, const Reconstruction& reconstruction) {
  const GridReport& report = *reconstruction.grid;
  if (!report.nodes) return grid_document(options.grid, report);
  const bool has_lattice = !options.index_space && !reconstruction.levels.empty();
  return placed_grid_document(
      options.grid_id.value_or(""), *report.nodes,
      has_lattice ? std::optional(reconstruction.transform[0] / kLatticeStepsPerVoxel) : std::nullopt);
}

Json stopped_by_document(StoppedBy reason) {
  switch (reason) {
    case StoppedBy::none:
      return nullptr;
    case StoppedBy::floor:
      return "floor";
    case StoppedBy::error_cap:
      return "error_cap";
  }
  return nullptr;
}

Json parts_document(const EncodedLevel& encoded, std::size_t level, const ManifestUrls& urls) {
  Json parts = Json::array();
  for (const auto& part : encoded.parts) {
    parts.push_back({{"url", urls.part(level, parts.size(), encoded.parts.size())},
                     {"bytes", part.bytes.size()},
                     {"sha256", sha256_hex(part.bytes)},
                     {"triangles", part.triangles}});
  }
  return parts;
}

std::size_t bytes_of(const EncodedLevel& encoded) {
  std::size_t bytes = 0;
  for (const auto& part : encoded.parts) bytes += part.bytes.size();
  return bytes;
}

Json distance_document(const ReconstructedLevel& level) {
  const auto& in_space = level.space_distance;
  return {{"mean_voxels", number_or_null(level.distance.mean_voxels)},
          {"max_voxels", number_or_null(level.distance.max_voxels)},
          {"mean", in_space ? number_or_null(in_space->mean) : Json(nullptr)},
          {"max", in_space ? number_or_null(in_space->max) : Json(nullptr)},
          {"samples", level.distance.samples}};
}

Json point_document(Vec3d point) {
  return {number_or_null(point.x), number_or_null(point.y), number_or_null(point.z)};
}

Json amplitude_document(const std::optional<BodySamples::Amplitude>& amplitude) {
  if (!amplitude) return nullptr;
  return {{"mean", number_or_null(amplitude->mean)},
          {"min", number_or_null(amplitude->min)},
          {"max", number_or_null(amplitude->max)}};
}

Json body_document(const DescribedBody& body, std::size_t number, bool measured) {
  const BodyReport& surface = body.surface;
  return {{"body", number},
          {"voxels", body.samples.voxels},
          {"volume", measured ? number_or_null(surface.volume) : Json(nullptr)},
          {"area", measured ? number_or_null(surface.area) : Json(nullptr)},
          {"bbox", {point_document(surface.low), point_document(surface.high)}},
          {"centroid", point_document(surface.centroid)},
          {"genus", surface.genus},
          {"cavities", surface.cavities},
          {"components", surface.components},
          {"amplitude", amplitude_document(body.samples.amplitude)},
          {"interpolated_share", number_or_null(surface.interpolated_share)},
          {"volume_voxels", number_or_null(surface.volume_voxels)}};
}

Json level_document(const ReconstructedLevel& level, std::size_t number, const VolumeSummary& volume,
                    const ReconstructOptions& options, const ManifestUrls& urls) {
  const bool measured = has_lengths(volume, options);
  const auto& topology = level.topology;
  const auto url = urls.level(number, level.encoded.parts.size());
  return {{"level", number},
          {"asked", asked_document(level.asked)},
          {"stopped_by", stopped_by_document(level.lod.stopped_by)},
          {"url", url ? Json(*url) : Json(nullptr)},
          {"parts", parts_document(level.encoded, number, urls)},
          {"bytes", bytes_of(level.encoded)},
          {"vertices", topology.vertices},
          {"triangles", topology.triangles},
          {"components", topology.components},
          {"euler", topology.euler},
          {"genus", topology.genus},
          {"boundary_loops", topology.boundary_loops},
          {"manifold", topology.manifold},
          {"area", measured ? number_or_null(level.measures.area) : Json(nullptr)},
          {"volume", measured ? number_or_null(level.measures.volume) : Json(nullptr)},
          {"distance", distance_document(level)},
          {"cost", number_or_null(level.lod.cost)},
          {"volume_drift", number_or_null(level.volume_drift)},
          {"interpolated_share", number_or_null(level.interpolated_share)},
          {"dropped_components", level.lod.dropped_components},
          {"preview", options.preview}};
}

}  // namespace

bool has_lengths(const VolumeSummary& volume, const ReconstructOptions& options) {
  return options.index_space || volume.sample_unit != "ms" || options.velocity.has_value();
}

Json manifest_document(const VolumeSummary& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls) {
  const Json request = request_document(options, volume.shape);
  const auto transform = output_transform(volume, options, reconstruction);
  Json levels = Json::array();
  for (const auto& level : reconstruction.levels) {
    levels.push_back(level_document(level, levels.size(), volume, options, urls));
  }
  Json manifest = {{"id", extraction_id(volume.id, request, kResultVersion)},
                   {"volume", volume.id},
                   {"engine", {{"name", "geosis"}, {"result_version", kResultVersion}}},
                   {"request", request},
                   {"transform", transform},
                   {"origin", {transform[3], transform[7], transform[11]}},
                   {"levels", levels},
                   {"empty", reconstruction.levels.empty()},
                   {"bodies_url", urls.bodies}};
  if (reconstruction.grid) manifest["grid"] = chosen_grid_document(options, reconstruction);
  return manifest;
}

Json manifest_document(const VolumeDescription& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls) {
  return manifest_document(summarize(volume), options, reconstruction, urls);
}

Json bodies_document(const VolumeSummary& volume, const ReconstructOptions& options,
                     const std::vector<DescribedBody>& bodies) {
  Json list = Json::array();
  for (const auto& body : bodies) list.push_back(body_document(body, list.size(), has_lengths(volume, options)));
  return {{"bodies", std::move(list)}};
}

Json early_level_document(const ReconstructedLevel& level, std::size_t number, const VolumeSummary& volume,
                          const ReconstructOptions& options, const ManifestUrls& urls) {
  Json entry = level_document(level, number, volume, options, urls);
  entry.erase("distance");
  entry.erase("volume_drift");
  return entry;
}

}  // namespace geosis::server
