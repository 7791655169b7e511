#include "server/http/wire/target_matcher.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "engine/base/hexadecimal.h"

namespace geosis::server::http {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Without percent-encoding. In a query + is a space.
std::optional<std::string> decoded(std::string_view text, bool is_query) {
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += is_query && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hexadecimal_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hexadecimal_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    plain += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return plain;
}

std::optional<std::multimap<std::string, std::string>> decoded_query(std::string_view text) {
  std::multimap<std::string, std::string> query;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(pair.size() + 1, text.size()));
    if (pair.empty()) continue;
    const std::string_view name = pair.substr(0, pair.find('='));
    auto plain_name = decoded(name, true);
    auto value = decoded(pair.substr(std::min(name.size() + 1, pair.size())), true);
    if (!plain_name || !value) return std::nullopt;
    query.emplace(*std::move(plain_name), *std::move(value));
  }
  return query;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    words.emplace_back(text.substr(0, text.find('|')));
    text.remove_prefix(std::min(words.back().size() + 1, text.size()));
  }
  return words;
}

/// How many characters at the start of the path are of this kind.
std::size_t run_length(std::string_view path, bool digits) {
  const auto end = std::find_if(path.begin(), path.end(), [=](char c) { return digits ? !is_digit(c) : c == '/'; });
  return static_cast<std::size_t>(end - path.begin());
}

}  // namespace

void TargetMatcher::add(std::string_view pattern) {
  using Kind = Piece::Kind;
  Pattern pieces;
  while (!pattern.empty()) {
    if (pattern.front() == '(') {
      const std::size_t end = pattern.find(')');
      if (end == std::string_view::npos) std::abort();
      const std::string_view inner = pattern.substr(1, end - 1);
      if (inner.empty() || inner.find('(') != std::string_view::npos) std::abort();
      pattern.remove_prefix(end + 1);
      const Kind kind = inner == "[^/]+" ? Kind::segment : inner == "[0-9]+" ? Kind::digits : Kind::word;
      pieces.push_back({kind, kind == Kind::word ? words_of(inner) : std::vector<std::string>()});
      continue;
    }
    if (pattern == ".*") {
      pieces.push_back({Kind::rest, {}});
      break;
    }
    if (pattern.front() == '\\') pattern.remove_prefix(1);
    if (pattern.empty()) std::abort();
    if (pieces.empty() || pieces.back().kind != Kind::text) pieces.push_back({Kind::text, {""}});
    pieces.back().texts.front() += pattern.front();
    pattern.remove_prefix(1);
  }
  patterns_.push_back(std::move(pieces));
}

bool TargetMatcher::matches(const Pattern& pattern, std::string_view path, std::vector<std::string>& captures) {
  for (const Piece& piece : pattern) {
    std::size_t length = 0;
    switch (piece.kind) {
      case Piece::Kind::rest:
        return true;
      case Piece::Kind::text:
      case Piece::Kind::word: {
        const auto found = std::find_if(piece.texts.begin(), piece.texts.end(),
                                        [&](const std::string& text) { return path.starts_with(text); });
        if (found == piece.texts.end()) return false;
        length = found->size();
        break;
      }
      case Piece::Kind::segment:
      case Piece::Kind::digits:
        length = run_length(path, piece.kind == Piece::Kind::digits);
        if (length == 0) return false;
        break;
    }
    if (piece.kind != Piece::Kind::text) captures.emplace_back(path.substr(0, length));
    path.remove_prefix(length);
  }
  return path.empty();
}

std::optional<TargetMatcher::Match> TargetMatcher::match(std::string_view target) const {
  const std::string_view path = target.substr(0, target.find('?'));
  auto plain = decoded(path, false);
  auto query = decoded_query(target.substr(std::min(path.size() + 1, target.size())));
  if (!plain || !query || std::any_of(plain->begin(), plain->end(), is_control)) return std::nullopt;
  Match match{std::nullopt, *std::move(plain), *std::move(query), {}};
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    match.captures.clear();
    if (matches(patterns_[i], match.path, match.captures)) {
      match.pattern = i;
      return match;
    }
  }
  match.captures.clear();
  return match;
}

}  // namespace geosis::server::http
