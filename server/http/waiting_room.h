#pragma once

#include <atomic>
#include <optional>
#include <utility>

namespace geosis::server::http {

/// Seats for requests that hold a handler's thread while something is computed. There are fewer seats than threads, so
/// that requests that wait never keep those that do not from being answered.
class WaitingRoom {
 public:
  explicit WaitingRoom(int seats) : free_(seats) {}

  class Seat {
   public:
    explicit Seat(WaitingRoom& room) : room_(&room) {}
    Seat(Seat&& other) noexcept : room_(std::exchange(other.room_, nullptr)) {}
    Seat& operator=(Seat&& other) noexcept {
      std::swap(room_, other.room_);
      return *this;
    }
    ~Seat() {
      if (room_) ++room_->free_;
    }

   private:
    WaitingRoom* room_;
  };

  /// Nothing when all are taken.
  std::optional<Seat> take() {
    if (--free_ >= 0) return Seat(*this);
    ++free_;
    return std::nullopt;
  }

 private:
  std::atomic<int> free_;
};

}  // namespace geosis::server::http
