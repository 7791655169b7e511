#include "server/app/extractions/level_export.h"

#include <cerrno>
#include <fstream>
#include <limits>
#include <vector>

#include "engine/base/digest.h"
#include "engine/codec/glb.h"
#include "engine/codec/level_codec.h"
#include "engine/codec/obj.h"
#include "engine/codec/ply.h"
#include "engine/codec/stl.h"
#include "server/documents/volume_document.h"
#include "server/store/piece_sums.h"

namespace geosis::server {
namespace {

// Streams do not say why; the last system call does.
Error write_failed(const std::filesystem::path& path) {
  const bool is_full = errno == ENOSPC || errno == EDQUOT;
  return {is_full ? ErrorCode::no_space : ErrorCode::unavailable, "writing " + path.filename().string() + " failed"};
}

Result<DecodedLevel> read_level(const Json& entry, int level, const PartReader& read_part, int threads) {
  std::vector<std::vector<std::byte>> parts;
  for (int p = 0; p < static_cast<int>(entry.at("parts").size()); ++p) {
    auto bytes = read_part(level, p);
    if (!bytes) return std::move(bytes).error();
    parts.push_back(*std::move(bytes));
  }
  return decode_level({parts.begin(), parts.end()}, threads);
}

Result<void> write_drc(std::ostream& out, const DecodedLevel& level, const EncodeOptions& options) {
  const auto encoded = encode_level(level.mesh, level.attributes, options);
  if (!encoded) return encoded.error();
  const auto& bytes = encoded->parts.front().bytes;
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return {};
}

Result<void> write_level(std::ostream& out, const DecodedLevel& level, LevelFormat format,
                         const std::array<double, 16>& transform) {
  const EncodeOptions options{.position_bits = position_bits_for(level.mesh),
                              .max_part_triangles = std::numeric_limits<std::int32_t>::max(),
                              .transform = transform};
  const auto map = [geometry = geometry_of(transform)](Vec3d p) { return geometry.map(p); };
  switch (format) {
    case LevelFormat::drc:
      return write_drc(out, level, options);
    case LevelFormat::glb:
      return write_glb(out, level.mesh, level.attributes, options);
    case LevelFormat::ply:
      return write_ply(out, level.mesh, level.attributes, map);
    case LevelFormat::obj:
      return write_obj(out, level.mesh, map);
    case LevelFormat::stl:
      return write_stl(out, level.mesh, map, {transform[3], transform[7], transform[11]});
  }
  return {};
}

Result<Json> describe(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> piece(kSummedPiece);
  Sha256 digest;
  std::uint64_t bytes = 0;
  Json sums = Json::array();
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    const auto read = std::as_bytes(std::span(piece.data(), count));
    digest.update(read);
    if (count > 0) sums.push_back(sum_of_piece(read));
    bytes += count;
  }
  if (!file.eof()) return write_failed(path);
  return Json{{"sha256", std::move(digest).hex()}, {"bytes", bytes}, {"sums", sums}};
}

}  // namespace

std::string level_file_name(int level, LevelFormat format) {
  return "levels/" + std::to_string(level) + "." + extension_of(format);
}

Result<Json> export_level(const std::filesystem::path& path, const Json& manifest, int level, LevelFormat format,
                          const PartReader& read_part, int threads, Progress& progress) {
  const auto decoded = read_level(manifest.at("levels").at(static_cast<std::size_t>(level)), level, read_part, threads);
  if (!decoded) return decoded.error();
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "the export was cancelled"};
  {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    const auto transform = manifest.at("transform").get<std::array<double, 16>>();
    if (auto written = write_level(out, *decoded, format, transform); !written) return std::move(written).error();
    out.close();
    if (!out) return write_failed(path);
  }
  return describe(path);
}

}  // namespace geosis::server
