#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include <xxhash.h>

#include "engine/base/result.h"

namespace geosis {

// How files of one volume begin: bricks, fills, laid and placed grids. Their headers are plain structures with the
// members
//
//   magic, version         first; a fresh header holds those of this program
//   file_bytes             of the whole file
//   checksum               XXH3-64 of the header with this field zero

/// kind   of file: "fill", "node". errors of one begin with it.
inline Error damaged_file(std::string_view kind, const std::string& what) {
  return {ErrorCode::malformed_input, std::string(kind) + " file: " + what};
}

inline std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

template <class Header>
std::uint64_t header_checksum(Header header) {
  header.checksum = 0;
  return checksum_of(std::as_bytes(std::span(&header, 1)));
}

/// The header of a file whose checksum is still to be compared.
///
/// errors   malformed_input: shorter than a header, another magic, another size than it says.  unsupported: a version.
template <class Header>
Result<Header> read_unchecked_header(std::string_view kind, std::span<const std::byte> file) {
  Header header;
  const Header own;
  if (file.size() < sizeof header) {
    return damaged_file(
        kind, std::to_string(file.size()) + " bytes, shorter than its header of " + std::to_string(sizeof header));
  }
  std::memcpy(&header, file.data(), sizeof header);
  if (header.magic != own.magic) {
    return damaged_file(kind, "does not start with " + std::string(own.magic.begin(), own.magic.end()));
  }
  if (header.version != own.version) {
    return Error{ErrorCode::unsupported, std::string(kind) + " file: version " + std::to_string(header.version) +
                                             "; this program reads " + std::to_string(own.version)};
  }
  if (header.file_bytes != file.size()) {
    return damaged_file(kind,
                        std::to_string(file.size()) + " bytes; its header says " + std::to_string(header.file_bytes));
  }
  return header;
}

/// The header of a file. errors: those of read_unchecked_header; malformed_input: it fails its checksum.
template <class Header>
Result<Header> read_header(std::string_view kind, std::span<const std::byte> file) {
  auto header = read_unchecked_header<Header>(kind, file);
  if (header && header_checksum(*header) != header->checksum) {
    return damaged_file(kind, "its header fails its checksum");
  }
  return header;
}

/// Parts of a file begin at multiples.
constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace geosis
