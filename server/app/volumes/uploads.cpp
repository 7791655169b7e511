#include "server/app/volumes/uploads.h"

#include <span>
#include <string>
#include <utility>

#include "server/app/volumes/arriving_file.h"
#include "server/app/volumes/imports.h"
#include "server/store/spool.h"

namespace geosis::server {
namespace {

constexpr std::size_t kPiece = 1 << 18;

}  // namespace

std::optional<std::uint64_t> arriving_bytes(const ImportOptions& options, std::optional<std::uint64_t> announced) {
  const auto expected = raw_file_bytes(options);
  return expected ? announced.value_or(*expected) : expected;
}

Result<UploadResult> import_arriving(const Services& services, CheckedBody& body, std::uint64_t bytes,
                                     UploadOptions options, Progress& progress,
                                     std::vector<GridCandidate>& candidates) {
  const ArrivingFile file(bytes, [&](std::span<std::byte> into) { return body.read(into); });
  options.confirm = [&, also = std::move(options.confirm)]() -> Result<void> {
    const auto more = goes_on(body);
    if (!more) return more.error();
    if (*more) {
      return Error{ErrorCode::malformed_input,
                   "raw: more than the " + std::to_string(bytes) + " bytes that dims and dtype make"};
    }
    if (auto same = body.check(); !same || !also) return same;
    return also();
  };
  return services.volumes.add(file, options, progress, candidates);
}

Result<std::unique_ptr<StagedFile>> spool_body(const Services& services, CheckedBody& body,
                                               std::optional<std::uint64_t> announced) {
  auto spool = Spool::open(services.store, announced);
  if (!spool) return std::move(spool).error();
  std::vector<std::byte> piece(kPiece);
  for (;;) {
    const auto count = body.read(piece);
    if (!count) return count.error();
    if (*count == 0) break;
    if (auto written = spool->write(std::span(piece).first(*count)); !written) return std::move(written).error();
  }
  if (auto same = body.check(); !same) return std::move(same).error();
  return spool->take();
}

Result<UploadResult> import_spooled(const Services& services, const StagedFile& file, const UploadOptions& options,
                                    Progress& progress, std::vector<GridCandidate>& candidates) {
  const auto source = open_file(file.path());
  if (!source) return source.error();
  return services.volumes.add(**source, options, progress, candidates);
}

Result<Json> import_later(const Services& services, std::shared_ptr<const StagedFile> file, UploadOptions options) {
  return Imports(services.store, services.volumes, services.queue)
      .begin(std::move(file), std::move(options), kImportMemoryBytes);
}

Result<std::shared_ptr<Extraction>> extract_spooled(const Services& services, const StagedFile& file,
                                                    const UploadOptions& options, const Json& request,
                                                    Progress& progress, std::vector<GridCandidate>& candidates) {
  const auto source = open_file(file.path());
  if (!source) return source.error();
  return services.extractions.create_transient(**source, options, request, progress, candidates);
}

}  // namespace geosis::server
