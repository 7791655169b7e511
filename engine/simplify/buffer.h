#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace geosis {

/// Room for so many elements, uninitialised: pages that are never written never become memory.
///
/// Elements come to life without a constructor, as C++20 allows for memory from operator new.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  Buffer() = default;
  explicit Buffer(std::size_t size)
      : elements_(static_cast<T*>(::operator new(size * sizeof(T), std::align_val_t(alignof(T))))), size_(size) {}
  Buffer(Buffer&& other) noexcept : elements_(std::move(other.elements_)), size_(std::exchange(other.size_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    elements_ = std::move(other.elements_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  Buffer clone() const {
    Buffer copy(size_);
    if (size_ > 0) std::memcpy(static_cast<void*>(copy.data()), data(), size_ * sizeof(T));
    return copy;
  }

  std::size_t size() const { return size_; }
  T* data() { return elements_.get(); }
  const T* data() const { return elements_.get(); }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }

 private:
  struct Free {
    void operator()(T* elements) const { ::operator delete(elements, std::align_val_t(alignof(T))); }
  };

  std::unique_ptr<T, Free> elements_;
  std::size_t size_ = 0;
};

}  // namespace geosis
