#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include <geosis/v1/extraction.pb.h>
#include <grpcpp/support/byte_buffer.h>

#include "engine/base/result.h"
#include "server/app/extractions/extraction_feed.h"

namespace geosis::server::rpc {

/// Messages that a call streams, made one by one as the client takes them.
template <class Message>
class MessageSource {
 public:
  enum class State { message, nothing_yet, end };

  virtual ~MessageSource() = default;
  /// Writes the next one over `message`. May read files, never waits for work that goes on. errors: the call's end.
  virtual Result<State> next(Message& message) = 0;
  /// bell   called from any thread after nothing_yet, when there may be more.
  virtual void on_ready(std::function<void()> bell) = 0;
};

/// after   id of the last event that the reader knows; after the very last one there is nothing to say.
std::unique_ptr<MessageSource<v1::ExtractionEvent>> event_source(std::shared_ptr<Extraction> extraction,
                                                                 std::uint64_t after);

/// LodChunk messages as they are on the wire: parts in chunks of 256 KiB, the manifest last. The bytes of a part are
/// sent from where they are: a LodChunk object would copy them twice. Destroyed before its end, `options.abandoned` is
/// called.
std::unique_ptr<MessageSource<grpc::ByteBuffer>> lod_source(std::shared_ptr<Extraction> extraction,
                                                            LevelFeed::Options options);

}  // namespace geosis::server::rpc
