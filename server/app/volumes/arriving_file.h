#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "engine/base/result.h"
#include "engine/volume/formats/byte_source.h"

namespace geosis::server {

/// A file whose bytes still arrive, as a source for imports that read in order: nothing of it is kept.
class ArrivingFile final : public ByteSource {
 public:
  /// Takes up to into.size() of the next bytes, waiting for at least one; 0 at the end.
  using Receive = std::function<Result<std::size_t>(std::span<std::byte>)>;

  /// size   what the sender has announced.
  ArrivingFile(std::uint64_t size, Receive receive) : size_(size), receive_(std::move(receive)) {}

  std::uint64_t size() const override { return size_; }
  /// errors   internal: out of order.  malformed_input: fewer bytes than announced.  Those of receiving.
  Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) const override {
    if (offset != position_) return Error{ErrorCode::internal, "an arriving file was read out of order"};
    while (!into.empty()) {
      const auto count = receive_(into);
      if (!count) return count.error();
      if (*count == 0) {
        return Error{ErrorCode::malformed_input, "file cut short: " + std::to_string(position_) + " bytes of " +
                                                     std::to_string(size_) + " arrived"};
      }
      into = into.subspan(*count);
      position_ += *count;
    }
    return {};
  }

 private:
  std::uint64_t size_;
  Receive receive_;
  mutable std::uint64_t position_ = 0;  // one thread reads
};

}  // namespace geosis::server
