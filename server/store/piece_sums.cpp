#include "server/store/piece_sums.h"

#include <fstream>

#include <xxhash.h>

namespace geosis::server {

std::uint64_t sum_of_piece(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

Result<std::vector<std::uint64_t>> sums_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::byte> piece(kSummedPiece);
  std::vector<std::uint64_t> sums;
  while (file) {
    file.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    if (count > 0) sums.push_back(sum_of_piece(std::span(piece).first(count)));
  }
  if (!file.eof()) return Error{ErrorCode::unavailable, "reading a stored file failed"};
  return sums;
}

}  // namespace geosis::server
