#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

namespace geosis::server::http {

/// How many bytes of bodies may be held at one time for readers who have not taken them yet. Any thread takes shares.
class BodyBudget {
 public:
  explicit BodyBudget(std::uint64_t bytes) : free_(static_cast<std::int64_t>(bytes)) {}

  class Share {
   public:
    Share() = default;
    Share(Share&& other) noexcept : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
    Share& operator=(Share&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Share() {
      if (budget_) budget_->free_ += bytes_;
    }

   private:
    friend class BodyBudget;
    Share(BodyBudget& budget, std::int64_t bytes) : budget_(&budget), bytes_(bytes) {}

    BodyBudget* budget_ = nullptr;
    std::int64_t bytes_ = 0;
  };

  /// Nothing when too many are held. Small bodies cost nothing: the number of connections bounds them.
  std::optional<Share> take(std::uint64_t bytes) {
    constexpr std::uint64_t kSmall = 64 * 1024;
    if (bytes <= kSmall) return Share();
    const auto wanted = static_cast<std::int64_t>(bytes);
    if ((free_ -= wanted) >= 0) return Share(*this, wanted);
    free_ += wanted;
    return std::nullopt;
  }

 private:
  std::atomic<std::int64_t> free_;
};

}  // namespace geosis::server::http
