#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <google/protobuf/message.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

namespace geosis::server::rpc {

/// False: the bytes are none of these messages.
bool parse(const grpc::ByteBuffer& bytes, google::protobuf::Message& message);

grpc::ByteBuffer serialized(const google::protobuf::Message& message);

/// Of a message on the wire.
inline std::size_t wire_bytes(const google::protobuf::Message& message) {
  return message.ByteSizeLong();
}
inline std::size_t wire_bytes(const grpc::ByteBuffer& message) {
  return message.Length();
}

/// Bytes in the pieces that gRPC received them in: shared with it, not copied.
using Slices = std::vector<grpc::Slice>;

/// The bytes of a message that has nothing but one field of bytes, as clients write chunks of a file.
///
/// field    its number, below 16.
/// returns  unset for any other message, which may still say the same in another way: that takes the whole parser.
///          A parser would copy a chunk twice.
std::optional<Slices> only_field(const grpc::ByteBuffer& message, int field);

}  // namespace geosis::server::rpc
