#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/app/byte_stream.h"
#include "server/app/volumes/body_reader.h"

namespace geosis::server::http {

/// A request as handlers see it: parsed, framed, decoded. Names of headers are lower case.
struct Request {
  std::string method, path;
  std::map<std::string, std::string> headers;
  std::multimap<std::string, std::string> query;
  std::vector<std::string> captures;  ///< of the route's pattern, in order
  std::string body;                   ///< of small bodies, complete
  std::optional<std::uint64_t> content_length;
  std::string route;  ///< the pattern that matched, with * for what varies; empty = none
  std::string request_id, trace_id;
  std::string tenant = "default";
  std::chrono::steady_clock::time_point received = std::chrono::steady_clock::now();

  /// The header's value, or nothing. name   in lower case.
  const std::string* header(const std::string& name) const {
    const auto entry = headers.find(name);
    return entry == headers.end() ? nullptr : &entry->second;
  }
};

struct Reply;

/// An answer that is not there yet. It holds its client's connection, and no thread.
///
/// The loop's thread calls all but finish(). Destroyed before finish(): its client went away.
class PendingReply {
 public:
  virtual ~PendingReply() = default;
  /// bell   called from any thread when is_ready() may have become true; called once, before the first is_ready().
  virtual void on_ready(std::function<void()> bell) = 0;
  /// Quick: asked after every bell, and a few times a second.
  virtual bool is_ready() const = 0;
  /// When finish() is called, ready or not.
  virtual std::chrono::steady_clock::time_point deadline() const = 0;
  /// Whether finish() has a true answer at any time: then nobody waits for it when the server stops.
  virtual bool can_end_early() const { return false; }
  /// The answer; called once, by a handler's thread. It may be pending again.
  virtual Reply finish() = 0;
};

/// An answer: a small body, a stream that the front writes itself, or one that comes later.
struct Reply {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;  ///< without Content-Length and Connection
  std::string body;
  std::shared_ptr<const std::string> shared;  ///< instead of the body: bytes that others hold as well
  std::unique_ptr<ByteStream> stream;         ///< instead of the body
  std::optional<std::uint64_t> length;        ///< of the stream; unset = chunked
  std::unique_ptr<PendingReply> pending;      ///< instead of all else
  /// Told the bytes on the wire when the answer is written (complete) or given up; of a pending one only when its
  /// client left before it came. Must not throw.
  std::function<void(std::uint64_t bytes, bool is_complete)> on_written = {};
};

/// An answer found without looking anywhere but in memory: the loop's own thread asks for it. Nothing = a handler does
/// it.
using QuickHandler = std::function<std::optional<Reply>(const Request&)>;
using Handler = std::function<Reply(const Request&)>;
using UploadHandler = std::function<Reply(const Request&, BodyReader&)>;

}  // namespace geosis::server::http
