#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "engine/base/digest.h"
#include "server/app/volumes/body_reader.h"
#include "server/grpc/messages/wire.h"
#include "server/net/rate_guard.h"

namespace geosis::server::rpc {

/// The chunks of a client's stream as the body of a file: gRPC's threads put them in, an upload's thread reads them.
/// Not much more than two megabytes are held; the client is asked for more when some have been read.
class ChunkInbox final : public CheckedBody {
 public:
  struct Options {
    std::uint64_t most_bytes;        ///< of the file
    std::uint64_t bytes_per_second;  ///< slower senders are given up
    std::chrono::milliseconds window;
  };

  /// ask_for_more   begins to receive the next message. From the reading thread.
  ChunkInbox(Options options, std::function<void()> ask_for_more);

  // gRPC's side; never blocks.
  /// What the sender has stated of the file: its digest, 32 bytes or empty, and its size. Before the first read.
  void expect(std::string sha256, std::optional<std::uint64_t> bytes);
  /// True: receive the next message now. False: that will be asked for.
  bool put(Slices chunk);
  /// The client has sent all.
  void end();
  /// Nothing more comes, and what is here is worth nothing. The first error stays.
  void break_off(Error error);

  // The upload's side.
  Result<std::size_t> read(std::span<std::byte> into) override;
  Result<void> check() override;

 private:
  /// Waits for bytes or the end. errors: as BodyReader.
  Result<void> wait(std::unique_lock<std::mutex>& lock);
  bool is_all_read() const { return next_ == reading_.size(); }
  /// Moves bytes that are here already. returns: how many.
  std::size_t take(std::span<std::byte> into);
  /// Room for others where these bytes were.
  void release(std::size_t count);

  const Options options_;
  const std::function<void()> ask_for_more_;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  Slices arrived_;
  std::uint64_t received_ = 0, held_ = 0;
  bool is_asking_owed_ = false, has_ended_ = false;
  std::string sha256_;
  std::optional<std::uint64_t> stated_bytes_;
  std::optional<Error> broken_;
  // Of the reading thread:
  Slices reading_;                    ///< what had arrived when it last looked
  std::size_t next_ = 0, begin_ = 0;  ///< slice of these, and byte of that, where it goes on
  RateGuard rate_;
  Sha256 digest_;
};

}  // namespace geosis::server::rpc
