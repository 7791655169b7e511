#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <grpcpp/support/byte_buffer.h>

#include "engine/base/progress.h"
#include "server/app/volumes/volumes.h"
#include "server/documents/import_options.h"
#include "server/grpc/calls/call.h"
#include "server/grpc/calls/chunk_inbox.h"
#include "server/grpc/messages/message_codec.h"
#include "server/grpc/messages/wire.h"

namespace geosis::server::rpc {

/// What the first message of a stream that brings a file says of it.
struct FileOptions {
  UploadOptions upload;
  std::string sha256;                  ///< 32 bytes; empty = not stated
  std::optional<std::uint64_t> bytes;  ///< announced
};

/// options   UploadOptions or ExtractOptions of the contract.
/// errors    invalid_argument: an option that takes no such value, a digest that is none.  limit_exceeded: more bytes
///           than this server takes.
template <class Options>
Result<FileOptions> file_options(const Options& options, const CallRoom& room) {
  FileOptions file;
  const auto import = document_of(options.import());
  if (!import) return import.error();
  if (auto set = set_import_options(file.upload.import, *import); !set) return std::move(set).error();
  file.sha256 = options.sha256();
  if (!file.sha256.empty() && file.sha256.size() != 32) {
    return Error{ErrorCode::invalid_argument,
                 "/sha256: " + std::to_string(file.sha256.size()) + " bytes; expected 32, or none"};
  }
  if (options.has_bytes()) file.bytes = options.bytes();
  if (file.bytes.value_or(0) > room.upload_bytes) {
    return Error{ErrorCode::limit_exceeded, "the file has " + std::to_string(*file.bytes) +
                                                " bytes; this server takes " + std::to_string(room.upload_bytes)};
  }
  return file;
}

/// The reading half of a call that brings a file: options, then chunks, then the end. The file gets a thread once some
/// of it is here. Called by gRPC's threads, which hand over one message at a time; never blocks.
///
/// Message   of the stream: options or a chunk.
template <class Message>
class FileReceiver {
 public:
  enum class Next { read_more, wait, start, refuse };

  FileReceiver(CallRoom& room, std::function<void()> ask_for_more)
      : room_(room),
        inbox_({.most_bytes = room.upload_bytes,
                .bytes_per_second = room.upload_bytes_per_second,
                .window = room.patience},
               std::move(ask_for_more)) {}

  /// A message, or the stream's end (!ok). What to do: receive another one, wait until asked to, start the file's
  /// thread, or end the call with refusal().
  Next take(const grpc::ByteBuffer& message, bool ok) {
    if (!file_) return ok ? take_options(message) : refuse("the stream ends before its options");
    reads_on_ = ok ? take_chunk(message) : end();
    if (!std::exchange(has_started_, true)) return Next::start;
    return reads_on_ ? Next::read_more : Next::wait;
  }
  bool has_started() const { return has_started_; }
  /// After start: whether to receive another message at once.
  bool reads_on() const { return reads_on_; }

  const Error& refusal() const { return *refusal_; }
  /// The first message, once there is a thread.
  const Message& options() const { return options_; }
  FileOptions& file() { return *file_; }
  ChunkInbox& inbox() { return inbox_; }

 private:
  Next take_options(const grpc::ByteBuffer& bytes) {
    if (!parse(bytes, options_) || options_.content_case() != Message::kOptions)
      return refuse("the first message must hold the options");
    auto file = file_options(options_.options(), room_);
    if (!file) return refuse(std::move(file).error());
    inbox_.expect(file->sha256, file->bytes);
    file_ = *std::move(file);
    return Next::read_more;
  }
  /// Both: whether to receive another one at once.
  bool take_chunk(const grpc::ByteBuffer& bytes) {
    if (auto chunk = only_field(bytes, Message::kChunkFieldNumber)) return inbox_.put(*std::move(chunk));
    Message message;
    if (parse(bytes, message) && message.content_case() == Message::kChunk)
      return inbox_.put({grpc::Slice(message.chunk())});
    inbox_.break_off({ErrorCode::invalid_argument, "each message after the options must hold a chunk"});
    return false;
  }
  bool end() {
    inbox_.end();
    return false;
  }
  Next refuse(const char* why) { return refuse(Error{ErrorCode::invalid_argument, why}); }
  Next refuse(Error error) {
    refusal_ = std::move(error);
    return Next::refuse;
  }

  CallRoom& room_;
  ChunkInbox inbox_;
  Message options_;
  std::optional<FileOptions> file_;
  std::optional<Error> refusal_;
  bool has_started_ = false, reads_on_ = false;
};

/// An import that ends when its client leaves.
class WatchedImport final : public Progress {
 public:
  explicit WatchedImport(const std::atomic<bool>& has_left) : has_left_(has_left) {}
  void report(const char*, double) override {}
  bool cancelled() const override { return has_left_; }

 private:
  const std::atomic<bool>& has_left_;
};

}  // namespace geosis::server::rpc
