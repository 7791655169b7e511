#pragma once

#include <memory>

#include "engine/base/result.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// Blobs that vanish with the store: for tests, and for requests that keep nothing. Staged and committed files lie in
/// a folder of their own below the system's temporary folder, put blobs in memory.
///
/// errors   unavailable: no temporary folder.
Result<std::unique_ptr<BlobStore>> open_memory_store();

}  // namespace geosis::server
