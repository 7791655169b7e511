#include "server/cli/level_table.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>

#include "server/documents/empty_reason.h"

namespace geosis::server {
namespace {

const char* stop_text(StoppedBy reason) {
  switch (reason) {
    case StoppedBy::none:
      return "-";
    case StoppedBy::floor:
      return "floor";
    case StoppedBy::error_cap:
      return "error_cap";
  }
  return "-";
}

std::size_t bytes_of(const EncodedLevel& encoded) {
  std::size_t bytes = 0;
  for (const auto& part : encoded.parts) bytes += part.bytes.size();
  return bytes;
}

std::string level_line(std::size_t number, const ReconstructedLevel& level) {
  const auto& topology = level.topology;
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(),
                "%5zu %10" PRId64 " %10" PRId64 " %10" PRId64 " %8" PRId64 " %6" PRId64 " %6" PRId64
                "  %-8s %9.4f %9.4f %+9.3f%% %8.2f%% %10zu %5zu  %s\n",
                number, topology.triangles, topology.vertices, topology.components, topology.euler, topology.genus,
                topology.boundary_loops, topology.manifold ? "yes" : "NO", level.distance.mean_voxels,
                level.distance.max_voxels, 100 * level.volume_drift, 100 * level.interpolated_share,
                bytes_of(level.encoded), level.encoded.parts.size(), stop_text(level.lod.stopped_by));
  return line.data();
}

std::string body_line(std::size_t number, const DescribedBody& body) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), "%5zu %13.1f %11" PRId64 " %6" PRId64 " %8" PRId64 "  %.1f, %.1f, %.1f\n",
                number, body.surface.volume_voxels, body.samples.voxels, body.surface.genus, body.surface.cavities,
                body.surface.centroid.x, body.surface.centroid.y, body.surface.centroid.z);
  return line.data();
}

}  // namespace

std::string level_table(const Reconstruction& reconstruction) {
  if (reconstruction.empty) return std::string(text_of(*reconstruction.empty)) + " There are no levels.\n";
  std::string table =
      "                                                                           distance/voxels     volume   inter-\n"
      "level  triangles   vertices components    euler  genus  loops  manifold      mean       max      drift   polated"
      "      bytes parts  stopped by\n";
  for (std::size_t number = 0; number < reconstruction.levels.size(); ++number) {
    table += level_line(number, reconstruction.levels[number]);
  }
  return table;
}

std::string body_table(const std::vector<DescribedBody>& bodies) {
  constexpr std::size_t kMostLines = 10;
  if (bodies.empty()) return "";
  std::string table = " body volume/voxels    samples  genus cavities  centroid x, y, z\n";
  for (std::size_t number = 0; number < std::min(bodies.size(), kMostLines); ++number) {
    table += body_line(number, bodies[number]);
  }
  if (bodies.size() > kMostLines) {
    table += "      and " + std::to_string(bodies.size() - kMostLines) + " smaller ones: see bodies.json\n";
  }
  return table;
}

}  // namespace geosis::server
