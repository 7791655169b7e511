#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/base/result.h"

namespace geosis::server {

/// Paths of files in PEM.
struct TlsFiles {
  std::string certificate;  ///< of the doors, and those that lead to it
  std::string key;          ///< the certificate's
  std::string
      client_authorities;  ///< one of them signed the certificates that clients must show; empty = they need none
};

/// What stands in them, tried: the key is the certificate's, and OpenSSL takes both.
struct TlsTexts {
  std::string certificate, key, client_authorities;
};

/// The doors' certificates, which somebody renews by writing or replacing their files while the doors are open. What
/// cannot be used, half of a renewal for example, is not taken: the last good ones stay.
class TlsCertificates {
 public:
  /// Told of every change of the files: nothing, or why what they hold is not taken.
  using Say = std::function<void(const std::optional<Error>& problem)>;

  /// errors   invalid_argument: a file that cannot be read or holds something else, a key of another certificate.
  static Result<std::unique_ptr<TlsCertificates>> read(const TlsFiles& files, Say say);

  /// The last good ones: the same object until there are others. Looks at the files once a second at most. Any thread.
  std::shared_ptr<const TlsTexts> latest();

 private:
  /// What tells that a file is another one, or was written to.
  struct Stamp {
    std::uint64_t device = 0, inode = 0;
    std::int64_t bytes = 0, seconds = 0, nanoseconds = 0;
    bool operator==(const Stamp&) const = default;
  };
  using Stamps = std::array<Stamp, 3>;
  TlsCertificates(TlsFiles files, Say say) : files_(std::move(files)), say_(std::move(say)) {}
  static Stamp stamp_of(const std::string& path);
  Stamps stamps() const;

  const TlsFiles files_;
  const Say say_;
  std::mutex mutex_;
  std::shared_ptr<const TlsTexts> texts_;
  Stamps read_{};  ///< when they were last read
  std::chrono::steady_clock::time_point looked_{};
};

}  // namespace geosis::server
