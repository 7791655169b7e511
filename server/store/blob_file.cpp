#include "server/store/blob_file.h"

#include <cerrno>
#include <cstdint>
#include <string>

#include <fcntl.h>

#include "server/store/blob_trailer.h"
#include "server/store/open_file.h"

namespace geosis::server {
namespace {

namespace fs = std::filesystem;

Error no_such_file() {
  return {ErrorCode::not_found, "there is no such file"};
}

}  // namespace

Result<void> write_blob_file(FileCalls& calls, const fs::path& path, std::span<const std::byte> bytes) {
  OpenFile file(calls, calls.open(path.c_str(), O_WRONLY, 0));
  const auto trailer = encode_trailer(trailer_of(bytes));
  const bool done = file.is_open() && file.write_all(bytes) == 0 && file.write_all(trailer) == 0 &&
                    calls.fsync(file.descriptor()) == 0 && file.close() == 0;
  if (!done) return file_error(path, "cannot write", errno);
  return {};
}

Result<void> flush_file(FileCalls& calls, const fs::path& path) {
  OpenFile file(calls, calls.open(path.c_str(), O_RDONLY, 0));
  if (!file.is_open() || calls.fsync(file.descriptor()) != 0) return file_error(path, "cannot flush", errno);
  return {};
}

Result<std::vector<std::byte>> read_blob_file(FileCalls& calls, const fs::path& path) {
  OpenFile file(calls, calls.open(path.c_str(), O_RDONLY, 0));
  if (!file.is_open() && (errno == ENOENT || errno == ENOTDIR)) return no_such_file();
  struct stat status {};
  if (!file.is_open() || calls.fstat(file.descriptor(), &status) != 0) return file_error(path, "cannot read", errno);
  if (!S_ISREG(status.st_mode)) return no_such_file();
  const auto file_bytes = static_cast<std::uint64_t>(status.st_size);
  BlobTrailer::Bytes trailer_bytes{};
  if (file_bytes >= BlobTrailer::kBytes && file.read_all(trailer_bytes, file_bytes - BlobTrailer::kBytes) != 0)
    return file_error(path, "cannot read", errno);
  const auto trailer = decode_trailer(trailer_bytes, file_bytes);
  if (!trailer) return trailer.error();
  std::vector<std::byte> payload(trailer->length);
  if (file.read_all(payload, 0) != 0) return file_error(path, "cannot read", errno);
  if (auto checked = check_payload(payload, *trailer); !checked) return std::move(checked).error();
  return payload;
}

}  // namespace geosis::server
