#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace geosis {

/// The last few planes of something that is computed plane by plane, inline after inline.
template <class Number>
class PlaneRing {
 public:
  PlaneRing(std::size_t numbers_a_plane, std::int32_t planes)
      : numbers_(numbers_a_plane), planes_(planes), data_(numbers_a_plane * static_cast<std::size_t>(planes)) {}

  std::int32_t planes() const { return planes_; }
  Number* plane(std::int32_t i) { return data_.data() + static_cast<std::size_t>(i % planes_) * numbers_; }
  const Number* plane(std::int32_t i) const { return data_.data() + static_cast<std::size_t>(i % planes_) * numbers_; }

 private:
  std::size_t numbers_;
  std::int32_t planes_;
  std::vector<Number> data_;
};

}  // namespace geosis
