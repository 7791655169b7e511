#include "server/cli/level_files.h"

#include <algorithm>
#include <optional>

#include "engine/codec/glb.h"
#include "engine/codec/obj.h"
#include "engine/codec/ply.h"
#include "engine/codec/stl.h"
#include "server/documents/volume_document.h"

namespace geosis::server {
namespace {

constexpr const char* kBodiesFile = "bodies.json";

std::string part_name(std::size_t level, std::size_t part, std::size_t parts) {
  const std::string name = "lod" + std::to_string(level);
  return parts == 1 ? name + ".drc" : name + "." + std::to_string(part) + ".drc";
}

Result<void> write_parts(OutputFolder& folder, const EncodedLevel& encoded, std::size_t level) {
  for (std::size_t part = 0; part < encoded.parts.size(); ++part) {
    const auto& bytes = encoded.parts[part].bytes;
    auto written = folder.write(part_name(level, part, encoded.parts.size()), [&](std::ostream& stream) {
      stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      return Result<void>();
    });
    if (!written) return written;
  }
  return {};
}

Result<void> write_document(OutputFolder& folder, const char* name, const Json& document) {
  const std::string text = document_text(document);
  return folder.write(name, [&](std::ostream& stream) {
    stream << text;
    return Result<void>();
  });
}

Result<void> write_exports(OutputFolder& folder, const ReconstructedLevel& made, std::size_t level, FileFormats formats,
                           const AffineGeometry& space) {
  const IndexedMesh& mesh = made.lod.mesh;
  const PositionMap to_space = [&](Vec3d index) { return space.map(index); };
  const auto write = [&](const char* extension, const auto& write_to) {
    return folder.write("lod" + std::to_string(level) + extension, write_to);
  };
  Result<void> written;
  if (formats.glb) {
    const EncodeOptions options{.position_bits = position_bits_for(mesh), .transform = *space.affine()};
    written = write(".glb", [&](std::ostream& stream) { return write_glb(stream, mesh, made.attributes, options); });
  }
  if (formats.ply && written) {
    written = write(".ply", [&](std::ostream& stream) { return write_ply(stream, mesh, made.attributes, to_space); });
  }
  if (formats.obj && written) {
    written = write(".obj", [&](std::ostream& stream) { return write_obj(stream, mesh, to_space); });
  }
  if (formats.stl && written) {
    written = write(".stl", [&](std::ostream& stream) { return write_stl(stream, mesh, to_space, space.map({})); });
  }
  return written;
}

/// What follows the prefix and a number in the text; nullopt when it does not begin so.
std::optional<std::string_view> without_number(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return std::nullopt;
  text.remove_prefix(prefix.size());
  const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
  if (digits == 0) return std::nullopt;
  return text.substr(digits);
}

}  // namespace

Result<FileFormats> parse_file_formats(std::string_view text) {
  FileFormats formats;
  while (!text.empty()) {
    const auto name = text.substr(0, text.find(','));
    text.remove_prefix(std::min(name.size() + 1, text.size()));
    if (name == "glb") {
      formats.glb = true;
    } else if (name == "ply") {
      formats.ply = true;
    } else if (name == "obj") {
      formats.obj = true;
    } else if (name == "stl") {
      formats.stl = true;
    } else if (name != "drc") {
      return Error{ErrorCode::invalid_argument,
                   "format \"" + std::string(name) + "\"; expected drc, glb, ply, obj or stl"};
    }
  }
  return formats;
}

ManifestUrls file_urls() {
  return {.level = [](std::size_t level, std::size_t parts) -> std::optional<std::string> {
            if (parts != 1) return std::nullopt;
            return part_name(level, 0, parts);
          },
          .part = part_name,
          .bodies = kBodiesFile};
}

bool is_result_file(const std::string& name) {
  if (name == "manifest.json" || name == kBodiesFile) return true;
  const auto after_level = without_number(name, "lod");
  if (!after_level) return false;
  for (const char* extension : {".drc", ".glb", ".ply", ".obj", ".stl"}) {
    if (*after_level == extension) return true;
  }
  return without_number(*after_level, ".") == ".drc";
}

Result<void> write_result(OutputFolder& folder, const VolumeSummary& volume, const ReconstructOptions& options,
                          const Results& results, FileFormats formats, Progress& progress) {
  const AffineGeometry space = geometry_of(results.reconstruction.transform);
  const auto& levels = results.reconstruction.levels;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (progress.cancelled())
      return Error{ErrorCode::cancelled, "stopped while writing level " + std::to_string(level)};
    progress.report("write", static_cast<double>(level) / static_cast<double>(levels.size()));
    if (auto written = write_parts(folder, levels[level].encoded, level); !written) return written;
    auto written = write_exports(folder, levels[level], level, formats, space);
    if (!written) return written;
  }
  auto written = write_document(folder, kBodiesFile, bodies_document(volume, options, results.bodies));
  if (!written) return written;
  return write_document(folder, "manifest.json",
                        manifest_document(volume, options, results.reconstruction, file_urls()));
}

}  // namespace geosis::server
