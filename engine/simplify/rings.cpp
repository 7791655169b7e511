#include "engine/simplify/rings.h"

#include <algorithm>
#include <utility>

namespace geosis {

void Rings::build(std::size_t vertices, std::span<const LocalTriangle> triangles) {
  places_.assign(vertices, {});
  for (const LocalTriangle& triangle : triangles) {
    for (const LocalVertex v : triangle) ++places_[v].degree;
  }
  std::uint32_t end = 0;
  for (Place& place : places_) {
    const std::uint32_t room = (place.degree + kStep - 1) / kStep * kStep;
    place = {end, 0, static_cast<std::uint16_t>(room)};
    end += room;
  }
  triangles_.assign(end + kPadding, {});
  for (auto& rooms : free_) rooms.clear();
  const auto add = [&](LocalVertex v, RingTriangle t) { triangles_[places_[v].first + places_[v].degree++] = t; };
  for (const auto& [a, b, c] : triangles) {
    add(a, {b, c});
    add(b, {c, a});
    add(c, {a, b});
  }
}

void Rings::merge(LocalVertex u, LocalVertex v, std::span<const RingTriangle> merged) {
  Place& place = places_[u];
  if (merged.size() > place.room) std::swap(place, places_[v]);
  if (merged.size() > place.room) {
    release(place);
    const std::uint32_t room = (static_cast<std::uint32_t>(merged.size()) + kStep - 1) / kStep * kStep;
    place = {allocate(room), 0, static_cast<std::uint16_t>(room)};
  }
  std::copy(merged.begin(), merged.end(), triangles_.begin() + place.first);
  place.degree = static_cast<std::uint16_t>(merged.size());
  release(places_[v]);
  places_[v] = {};
}

std::uint32_t Rings::allocate(std::uint32_t room) {
  auto& rooms = free_[std::min(room / kStep, kReusedRooms - 1)];
  if (room / kStep < kReusedRooms && !rooms.empty()) {
    const std::uint32_t first = rooms.back();
    rooms.pop_back();
    return first;
  }
  const auto first = static_cast<std::uint32_t>(triangles_.size()) - kPadding;
  triangles_.resize(triangles_.size() + room);
  return first;
}

void Rings::release(const Place& place) {
  if (place.room / kStep < kReusedRooms) free_[place.room / kStep].push_back(place.first);
}

}  // namespace geosis
