#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

namespace geosis::server {

/// Memory that requests may take together, counted by estimate: whoever begins something big reserves first.
/// Any thread may call any member. Outlives its reservations.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t total_bytes) : total_(total_bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  /// Gives its bytes back when it goes.
  class [[nodiscard]] Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Reservation() {
      if (budget_) budget_->release(bytes_);
    }
    std::uint64_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    Reservation(MemoryBudget& budget, std::uint64_t bytes) : budget_(&budget), bytes_(bytes) {}

    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
  };

  /// Nothing when that much is not free now.
  std::optional<Reservation> reserve(std::uint64_t bytes);
  /// False for what would not fit were everything free.
  bool can_ever_hold(std::uint64_t bytes) const { return bytes <= total_; }

  std::uint64_t total() const { return total_; }
  std::uint64_t reserved() const;
  /// Called after bytes were given back, from whatever thread did so and without any lock held. Set once, before the
  /// first reservation; must not throw.
  void on_release(std::function<void()> bell) { bell_ = std::move(bell); }

 private:
  void release(std::uint64_t bytes);

  const std::uint64_t total_;
  std::function<void()> bell_;
  mutable std::mutex mutex_;
  std::uint64_t reserved_ = 0;
};

}  // namespace geosis::server
