#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace geosis::server::http {

/// Decodes a request's target and finds the pattern its path matches.
///
/// The one place that knows cpp-httplib, and all that is asked of it: it is shown a request line over a stream in
/// memory and never meets a socket, a header, a body or a range, where its hardening ends.
class TargetMatcher {
 public:
  TargetMatcher();
  TargetMatcher(TargetMatcher&&) noexcept;
  TargetMatcher& operator=(TargetMatcher&&) noexcept;
  ~TargetMatcher();

  /// pattern   a regular expression for the whole decoded path; a broken one is our own mistake and ends the program.
  void add(const std::string& pattern) noexcept;

  struct Match {
    std::optional<std::size_t> pattern;  ///< the first added one that matches
    std::string path;                    ///< decoded
    std::multimap<std::string, std::string> query;
    std::vector<std::string> captures;
  };
  /// Nothing when the target cannot be decoded, or decodes to control characters.
  std::optional<Match> match(const std::string& target) const;

 private:
  class PatternServer;
  std::unique_ptr<PatternServer> server_;
  std::size_t count_ = 0;
};

}  // namespace geosis::server::http
