#pragma once

#include <filesystem>
#include <memory>

#include "engine/base/result.h"
#include "server/store/blob_store.h"
#include "server/store/file_calls.h"

namespace geosis::server {

/// Blobs in a directory, which any number of processes may share:
///
///     root/objects/<key>                  a blob: its bytes and a trailer (docs/formats/blob-file.md), or a committed
///     file root/staging/process-XXXXXX/<n>     files being made, in a folder that its process locks
///
/// Makes the directory if needed and removes the staging folders of processes that are gone.
///
/// calls    the system calls to use; must outlive the store and its staged files.
/// errors   no_space, unavailable.
/// cost     put and commit: fsync of the file and of its folder; the first in a folder also flushes those above it.
Result<std::unique_ptr<BlobStore>> open_dir_store(const std::filesystem::path& root,
                                                  FileCalls& calls = system_file_calls());

}  // namespace geosis::server
