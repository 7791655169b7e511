#include "server/jobs/memory_budget.h"

namespace geosis::server {

std::optional<MemoryBudget::Reservation> MemoryBudget::reserve(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes > total_ - reserved_) return std::nullopt;
  reserved_ += bytes;
  return Reservation(*this, bytes);
}

std::uint64_t MemoryBudget::reserved() const {
  const std::lock_guard lock(mutex_);
  return reserved_;
}

void MemoryBudget::release(std::uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    reserved_ -= bytes;
  }
  if (bell_) bell_();
}

}  // namespace geosis::server
