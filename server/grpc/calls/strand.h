#pragma once

#include <atomic>
#include <memory>

#include "server/jobs/handler_pool.h"

namespace geosis::server::rpc {

/// A call's thread of events: gRPC's own threads only note what happened and poke; what follows from it is done in
/// step(), on a handler's thread, never twice at a time. So a call needs no locks, and gRPC's threads never wait for a
/// disk.
class Strand : public std::enable_shared_from_this<Strand> {
 public:
  explicit Strand(HandlerPool& pool, HandlerPool::Lane lane = HandlerPool::Lane::reading) : pool_(pool), lane_(lane) {}
  Strand(const Strand&) = delete;
  Strand& operator=(const Strand&) = delete;
  virtual ~Strand() = default;

  /// The first poke of a call, which may be refused: false = the handlers have too much to do already.
  bool begin();
  /// Something happened: step() will run after this. From any thread.
  void poke();

 protected:
  /// Must not throw.
  virtual void step() = 0;

 private:
  void run();

  HandlerPool& pool_;
  const HandlerPool::Lane lane_;
  std::atomic<int> pokes_{0};  ///< that no finished step() has seen
};

}  // namespace geosis::server::rpc
