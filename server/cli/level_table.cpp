#include "server/cli/level_table.h"

#include <array>
#include <cinttypes>
#include <cstdio>

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
                "%5zu %10" PRId64 " %10" PRId64 " %10" PRId64 " %8" PRId64 " %6" PRId64
                "  %-8s %9.4f %9.4f %10zu %5zu  %s\n",
                number, topology.triangles, topology.vertices, topology.components, topology.euler, topology.genus,
                topology.manifold ? "yes" : "NO", level.distance.mean_voxels, level.distance.max_voxels,
                bytes_of(level.encoded), level.encoded.parts.size(), stop_text(level.lod.stopped_by));
  return line.data();
}

}  // namespace

std::string level_table(const Reconstruction& reconstruction) {
  if (reconstruction.levels.empty()) return "Nothing lies in the range: no levels.\n";
  std::string table =
      "                                                                    distance/voxels\n"
      "level  triangles   vertices components    euler  genus  manifold      mean       max      bytes parts  stopped "
      "by\n";
  for (std::size_t number = 0; number < reconstruction.levels.size(); ++number) {
    table += level_line(number, reconstruction.levels[number]);
  }
  return table;
}

}  // namespace geosis::server
