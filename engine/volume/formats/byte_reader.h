#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace geosis {

static_assert(std::endian::native == std::endian::little, "numbers are read on little-endian machines");

template <class T>
constexpr T swap_bytes(T value) {
  if constexpr (sizeof(T) == 1) return value;
  if constexpr (sizeof(T) == 2) return static_cast<T>(__builtin_bswap16(static_cast<std::uint16_t>(value)));
  if constexpr (sizeof(T) == 4) return static_cast<T>(__builtin_bswap32(static_cast<std::uint32_t>(value)));
  if constexpr (sizeof(T) == 8) return static_cast<T>(__builtin_bswap64(static_cast<std::uint64_t>(value)));
}

/// The number at `bytes`, in whatever alignment.
template <class T>
T load(const std::byte* bytes, bool big_endian) {
  static_assert(std::is_integral_v<T>);
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return big_endian ? swap_bytes(value) : value;
}

template <class T>
void store_big(std::byte* bytes, T value) {
  static_assert(std::is_integral_v<T>);
  value = swap_bytes(value);
  std::memcpy(bytes, &value, sizeof value);
}

/// Header words of a SEG-Y file at their 1-based byte positions, as the standard counts them.
class HeaderView {
 public:
  HeaderView(std::span<const std::byte> bytes, int first_byte, bool big_endian)
      : bytes_(bytes), first_byte_(first_byte), big_endian_(big_endian) {}

  /// The word must lie within the header.
  template <class T>
  T at(int byte) const {
    return load<T>(bytes_.data() + (byte - first_byte_), big_endian_);
  }

 private:
  std::span<const std::byte> bytes_;
  int first_byte_;
  bool big_endian_;
};

}  // namespace geosis
