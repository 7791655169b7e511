#pragma once

#include <map>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/http/routing/exchange.h"
#include "server/store/blob_store.h"

namespace geosis::server::http {

/// The file of an upload, spooled to the store's staging: memory stays flat whatever its size.
struct ReceivedFile {
  std::unique_ptr<StagedFile> file;
  std::string name;                           ///< as a form calls it; empty otherwise
  std::map<std::string, std::string> fields;  ///< text fields of a form
};

/// The body itself, or the part `file` of a multipart/form-data body; held against the request's Content-Digest.
///
/// errors   those of the reader and the form; invalid_argument: another digest; no_space: the disk is full.
Result<ReceivedFile> receive_file(const Request& request, BodyReader& wire, BlobStore& store);

}  // namespace geosis::server::http
