#include "server/grpc/calls/strand.h"

namespace geosis::server::rpc {

bool Strand::begin() {
  pokes_ = 1;
  return pool_.submit(lane_, [self = shared_from_this()] { self->run(); });
}

void Strand::poke() {
  if (pokes_.fetch_add(1) > 0) return;
  pool_.resume(lane_, [self = shared_from_this()] { self->run(); });  // the pool outlives all calls
}

void Strand::run() {
  for (int seen = pokes_.load(); seen > 0;) {
    step();
    seen = pokes_.fetch_sub(seen) - seen;
  }
}

}  // namespace geosis::server::rpc
