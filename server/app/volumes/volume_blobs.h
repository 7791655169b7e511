#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "engine/base/result.h"
#include "server/documents/json_text.h"

namespace geosis::server {

// Names of what the store has of one volume, below <tenant>/volumes/<id>/.
inline constexpr const char* kVolume = "volume.json";  ///< there = the volume is there
inline constexpr const char* kUploads = "data/";  ///< a folder for each upload; volume.json names the one that counts

// Names within the folder of an upload.
inline constexpr const char* kBricks = "bricks";
inline constexpr const char* kSidecar = "sidecar.json";

/// The field of a stored volume.json that names its upload. Not shown to anybody.
inline constexpr const char* kUpload = "upload";

/// "data/<upload>/"; "" for none.
inline std::string upload_folder(const std::string& upload) {
  std::string folder;
  if (!upload.empty()) folder.append(kUploads).append(upload).append("/");
  return folder;
}

/// Where the bricks and the sidecar of a stored volume are.
inline std::string data_folder(const Json& volume) {
  return upload_folder(volume.value(kUpload, ""));
}

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

inline Error no_such_volume(const std::string& id) {
  return {ErrorCode::not_found, "volume " + id + ": there is no such volume"};
}

/// The document of the outside contract, from the stored ones.
Json public_document(const Json& volume, const Json& sidecar);

/// The process that made an upload or holds a lease: what precedes the number in "process-x1y2z3.17".
inline std::string process_of(const std::string& token) {
  return token.substr(0, token.rfind('.'));
}

}  // namespace geosis::server
