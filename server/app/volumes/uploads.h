#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "server/app/services.h"
#include "server/app/volumes/body_reader.h"

namespace geosis::server {

/// Size of the file that a body is, when the file can be imported while it arrives.
///
/// announced   bytes of the body, where its sender said so.
std::optional<std::uint64_t> arriving_bytes(const ImportOptions& options, std::optional<std::uint64_t> announced);

/// Imports a body as it arrives: it is written once, as bricks.
///
/// bytes        arriving_bytes().
/// candidates   filled as import_volume does.
/// errors       those of Volumes::add and of the body; malformed_input: it goes on after these bytes.
Result<UploadResult> import_arriving(const Services& services, CheckedBody& body, std::uint64_t bytes,
                                     UploadOptions options, Progress& progress, std::vector<GridCandidate>& candidates);

/// A body as a file in the store's staging. errors: those of Spool and of the body.
Result<std::unique_ptr<StagedFile>> spool_body(const Services& services, CheckedBody& body,
                                               std::optional<std::uint64_t> announced);

/// Imports a file that has arrived. errors: those of Volumes::add.
Result<UploadResult> import_spooled(const Services& services, const StagedFile& file, const UploadOptions& options,
                                    Progress& progress, std::vector<GridCandidate>& candidates);

/// The same after the answer: a document of how it goes. errors: those of Imports::begin.
Result<Json> import_later(const Services& services, std::shared_ptr<const StagedFile> file, UploadOptions options);

/// One shot: the body of a file's range; nothing is kept. errors: those of Extractions::create_transient.
Result<std::shared_ptr<Extraction>> extract_spooled(const Services& services, const StagedFile& file,
                                                    const UploadOptions& options, const Json& request,
                                                    Progress& progress, std::vector<GridCandidate>& candidates);

}  // namespace geosis::server
