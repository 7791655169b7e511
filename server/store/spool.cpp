#include "server/store/spool.h"

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>

namespace geosis::server {

Result<Spool> Spool::open(BlobStore& store, std::optional<std::uint64_t> bytes) {
  auto staged = store.stage();
  if (!staged) return std::move(staged).error();
  const std::filesystem::path& path = (*staged)->path();
  std::error_code unknown;
  const auto space = std::filesystem::space(path.parent_path(), unknown);
  if (!unknown && bytes && *bytes > space.available) {
    return Error{ErrorCode::no_space, "the body has " + std::to_string(*bytes) + " bytes; the store's disk has " +
                                          std::to_string(space.available) + " left"};
  }
  FileCalls& calls = system_file_calls();
  OpenFile file(calls, calls.open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!file.is_open()) return Error{ErrorCode::unavailable, "the store's staging cannot be written"};
  return Spool(*std::move(staged), std::move(file));
}

Result<void> Spool::write(std::span<const std::byte> bytes) {
  if (file_.write_all(bytes) == 0) return {};
  if (errno == ENOSPC || errno == EDQUOT) return Error{ErrorCode::no_space, "the store's disk is full"};
  return Error{ErrorCode::unavailable, "writing the received file failed"};
}

std::unique_ptr<StagedFile> Spool::take() {
  file_.close();
  return std::move(staged_);
}

}  // namespace geosis::server
