#include "server/http/wire/content_digest.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <openssl/evp.h>

#include "server/http/routing/parameters.h"
#include "server/http/wire/head_parser.h"

namespace geosis::server::http {
namespace {

using Algorithm = StatedDigest::Algorithm;

struct Known {
  Algorithm algorithm;
  std::string_view name;
  std::size_t bytes;
};
constexpr std::array<Known, 2> kKnown = {Known{Algorithm::sha256, "sha-256", 32}, {Algorithm::sha512, "sha-512", 64}};

const Known& known(Algorithm algorithm) {
  return kKnown[algorithm == Algorithm::sha256 ? 0 : 1];
}

/// Base64 with its padding, of exactly so many bytes.
std::optional<std::vector<unsigned char>> from_base64(std::string_view text, std::size_t count) {
  const std::size_t groups = (count + 2) / 3, padding = groups * 3 - count;
  const bool is_padded = text.size() == groups * 4 && text.find('=') == (padding ? text.size() - padding : text.npos);
  if (!is_padded) return std::nullopt;
  std::vector<unsigned char> bytes(groups * 3);
  const auto* in = reinterpret_cast<const unsigned char*>(text.data());
  if (EVP_DecodeBlock(bytes.data(), in, static_cast<int>(text.size())) < 0) return std::nullopt;
  bytes.resize(count);
  return bytes;
}

std::string to_base64(std::span<const unsigned char> bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // and the library's zero
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

}  // namespace

Result<std::vector<StatedDigest>> stated_digests(const Request& request) {
  std::vector<StatedDigest> stated;
  const std::string text = header(request, "content-digest");
  for (std::string_view list = text; !list.empty();) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view element = trimmed(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
    const std::string_view name = element.substr(0, element.find('='));
    const auto* found = std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return k.name == name; });
    if (found == kKnown.end()) continue;
    const std::string_view value = element.substr(std::min(name.size() + 1, element.size()));
    const bool is_binary = value.size() >= 2 && value.front() == ':' && value.back() == ':';
    auto bytes = is_binary ? from_base64(value.substr(1, value.size() - 2), found->bytes) : std::nullopt;
    if (!bytes) {
      return Error{ErrorCode::invalid_argument, "header Content-Digest: " + std::string(name) + " is not base64 of " +
                                                    std::to_string(found->bytes) + " bytes between colons"};
    }
    stated.push_back({found->algorithm, *std::move(bytes)});
  }
  return stated;
}

class DigestedBody::Hash {
 public:
  explicit Hash(StatedDigest stated) : stated_(std::move(stated)), context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), stated_.algorithm == Algorithm::sha256 ? EVP_sha256() : EVP_sha512(), nullptr);
  }

  void update(std::span<const std::byte> bytes) { EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()); }

  Result<void> check() {
    std::vector<unsigned char> bytes(stated_.bytes.size());
    EVP_DigestFinal_ex(context_.get(), bytes.data(), nullptr);
    if (bytes == stated_.bytes) return {};
    const std::string name(known(stated_.algorithm).name);
    return Error{ErrorCode::invalid_argument, "header Content-Digest: " + name + " of the body is " + to_base64(bytes) +
                                                  "; the request states " + to_base64(stated_.bytes)};
  }

 private:
  StatedDigest stated_;
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

DigestedBody::DigestedBody(BodyReader& body, std::vector<StatedDigest> stated) : body_(body) {
  for (StatedDigest& digest : stated) hashes_.push_back(std::make_unique<Hash>(std::move(digest)));
}

DigestedBody::~DigestedBody() = default;

Result<std::size_t> DigestedBody::read(std::span<std::byte> into) {
  auto count = body_.read(into);
  if (count) {
    for (const auto& hash : hashes_) hash->update(into.first(*count));
  }
  return count;
}

Result<void> DigestedBody::check() {
  if (hashes_.empty()) return {};
  std::array<std::byte, 4096> rest;
  for (;;) {
    const auto count = read(rest);
    if (!count) return count.error();
    if (*count == 0) break;
  }
  for (const auto& hash : hashes_) {
    if (auto same = hash->check(); !same) return same;
  }
  return {};
}

}  // namespace geosis::server::http
