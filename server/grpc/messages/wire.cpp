#include "server/grpc/messages/wire.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include <grpcpp/impl/codegen/proto_utils.h>

namespace geosis::server::rpc {
namespace {

constexpr int kLengthDelimited = 2;  // the wire type of bytes
constexpr int kMostLengthBits = 35;  // five bytes, as parsers have it

/// The bytes of slices one by one, from the first on.
class Front {
 public:
  explicit Front(Slices& slices) : slices_(slices) {}

  std::optional<std::uint8_t> next() {
    while (slice_ < slices_.size() && at_ == slices_[slice_].size()) {
      ++slice_;
      at_ = 0;
    }
    if (slice_ == slices_.size()) return std::nullopt;
    return slices_[slice_].begin()[at_++];
  }
  /// A number of seven bits a byte.
  std::optional<std::uint64_t> varint() {
    std::uint64_t number = 0;
    for (int shift = 0; shift < kMostLengthBits; shift += 7) {
      const auto byte = next();
      if (!byte) return std::nullopt;
      number |= std::uint64_t{*byte & 0x7Fu} << shift;
      if (*byte < 0x80) return number;
    }
    return std::nullopt;
  }
  /// What has not been read; then nothing is left.
  Slices rest() {
    Slices rest;
    for (; slice_ < slices_.size(); ++slice_, at_ = 0) {
      if (at_ == 0)
        rest.push_back(std::move(slices_[slice_]));
      else if (at_ < slices_[slice_].size())
        rest.push_back(slices_[slice_].sub(at_, slices_[slice_].size()));
    }
    return rest;
  }

 private:
  Slices& slices_;
  std::size_t slice_ = 0, at_ = 0;
};

}  // namespace

bool parse(const grpc::ByteBuffer& bytes, google::protobuf::Message& message) {
  grpc::ByteBuffer read = bytes;  // which is emptied; the bytes themselves are shared
  return grpc::SerializationTraits<google::protobuf::Message>::Deserialize(&read, &message).ok();
}

grpc::ByteBuffer serialized(const google::protobuf::Message& message) {
  const grpc::Slice bytes(message.SerializeAsString());
  return {&bytes, 1};
}

std::optional<Slices> only_field(const grpc::ByteBuffer& message, int field) {
  Slices slices;
  if (!message.Dump(&slices).ok()) return std::nullopt;
  Front front(slices);
  if (front.next() != static_cast<std::uint8_t>(field << 3 | kLengthDelimited)) return std::nullopt;
  const auto length = front.varint();
  Slices rest = front.rest();
  std::uint64_t bytes = 0;
  for (const grpc::Slice& slice : rest) bytes += slice.size();
  if (length != bytes) return std::nullopt;
  return rest;
}

}  // namespace geosis::server::rpc
