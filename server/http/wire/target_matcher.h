#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace geosis::server::http {

/// Decodes a request's target and finds the pattern its path matches, in one pass over the path for each pattern and
/// without going back: no target takes longer than its length.
///
/// A pattern is literal text, in which these stand for more:
///
///     ([^/]+)      one or more characters of a segment, captured
///     ([0-9]+)     one or more digits, captured
///     (drc|glb)    one of these words, captured; none may begin another
///     .*           whatever follows, at the end only
///     \x           the character x itself
class TargetMatcher {
 public:
  /// A broken pattern is our own mistake and ends the program.
  void add(std::string_view pattern);

  struct Match {
    std::optional<std::size_t> pattern;  ///< number of the first added one that matches
    std::string path;                    ///< decoded
    std::multimap<std::string, std::string> query;
    std::vector<std::string> captures;
  };
  /// Nothing when the target is not percent-encoded well, or its path decodes to control characters.
  std::optional<Match> match(std::string_view target) const;

 private:
  struct Piece {
    enum class Kind { text, segment, digits, word, rest } kind = Kind::text;
    std::vector<std::string> texts;  ///< the text, or the words
  };
  using Pattern = std::vector<Piece>;

  static bool matches(const Pattern& pattern, std::string_view path, std::vector<std::string>& captures);

  std::vector<Pattern> patterns_;
};

}  // namespace geosis::server::http
