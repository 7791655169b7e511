#include "server/documents/manifest.h"

#include "engine/base/digest.h"
#include "server/documents/ids.h"
#include "server/documents/request.h"

namespace geosis::server {
namespace {

/// Index positions to the requested space, row-major.
std::array<double, 16> output_transform(const VolumeSummary& volume, const ReconstructOptions& options) {
  return options.index_space ? *AffineGeometry().affine() : *volume.geometry.affine();
}

/// Two axes in metres and one in milliseconds make no area: measures in such a space have no meaning.
bool has_measures(const VolumeSummary& volume, const ReconstructOptions& options) {
  return options.index_space || volume.sample_unit != "ms";
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

/// The distance is measured in voxels; it is a length of the requested space when that is the index space.
Json distance_document(const SurfaceDistance& distance, bool index_space) {
  const Json mean = number_or_null(distance.mean_voxels);
  const Json max = number_or_null(distance.max_voxels);
  return {{"mean_voxels", mean},
          {"max_voxels", max},
          {"mean", index_space ? mean : Json(nullptr)},
          {"max", index_space ? max : Json(nullptr)},
          {"samples", distance.samples}};
}

Json level_document(const ReconstructedLevel& level, std::size_t number, const VolumeSummary& volume,
                    const ReconstructOptions& options, const ManifestUrls& urls) {
  const bool measured = has_measures(volume, options);
  const auto& topology = level.topology;
  const auto url = urls.level(number, level.encoded.parts.size());
  return {{"level", number},
          {"asked", {{"ratio", level.lod.asked_ratio}}},
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
          {"distance", distance_document(level.distance, options.index_space)},
          {"cost", number_or_null(level.lod.cost)},
          {"volume_drift", number_or_null(level.volume_drift)},
          {"interpolated_share", 0},  // nothing is filled in, so nothing was interpolated
          {"dropped_components", 0},
          {"preview", false}};
}

}  // namespace

Json manifest_document(const VolumeSummary& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls) {
  const Json request = request_document(options, volume.shape);
  const auto transform = output_transform(volume, options);
  Json levels = Json::array();
  for (const auto& level : reconstruction.levels) {
    levels.push_back(level_document(level, levels.size(), volume, options, urls));
  }
  return {{"id", extraction_id(volume.id, request, kResultVersion)},
          {"volume", volume.id},
          {"engine", {{"name", "geosis"}, {"result_version", kResultVersion}}},
          {"request", request},
          {"transform", transform},
          {"origin", {transform[3], transform[7], transform[11]}},
          {"levels", levels},
          {"empty", reconstruction.levels.empty()},
          {"bodies_url", nullptr}};
}

Json manifest_document(const VolumeDescription& volume, const ReconstructOptions& options,
                       const Reconstruction& reconstruction, const ManifestUrls& urls) {
  return manifest_document(summarize(volume), options, reconstruction, urls);
}

Json early_level_document(const ReconstructedLevel& level, std::size_t number, const VolumeSummary& volume,
                          const ReconstructOptions& options, const ManifestUrls& urls) {
  Json entry = level_document(level, number, volume, options, urls);
  entry.erase("distance");
  entry.erase("volume_drift");
  return entry;
}

}  // namespace geosis::server
