#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>

namespace geosis::server {

/// Places of which only so many can be taken at one time. Any thread may call any member. Outlives the places.
class Slots {
 public:
  explicit Slots(std::size_t most) : most_(most), free_(most) {}
  Slots(const Slots&) = delete;
  Slots& operator=(const Slots&) = delete;

  /// A place, as long as it lives.
  class Slot {
   public:
    explicit Slot(Slots& slots) : slots_(&slots) {}
    Slot(Slot&& other) noexcept : slots_(std::exchange(other.slots_, nullptr)) {}
    Slot& operator=(Slot&&) = delete;
    ~Slot() {
      if (slots_ != nullptr) ++slots_->free_;
    }

   private:
    Slots* slots_;
  };
  std::optional<Slot> take() {
    for (std::size_t seen = free_; seen > 0;) {
      if (free_.compare_exchange_weak(seen, seen - 1)) return std::optional<Slot>(std::in_place, *this);
    }
    return std::nullopt;
  }
  bool has_room() const { return free_ > 0; }
  std::size_t most() const { return most_; }

 private:
  const std::size_t most_;
  std::atomic<std::size_t> free_;
};

}  // namespace geosis::server
