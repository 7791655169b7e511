#include "server/http/wire/conditional.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "server/http/routing/error_reply.h"
#include "server/http/wire/head_parser.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {
namespace {

const std::string* find_header(const Reply& reply, std::string_view lower_name) {
  const auto found = std::find_if(reply.headers.begin(), reply.headers.end(),
                                  [&](const auto& header) { return lower_case(header.first) == lower_name; });
  return found == reply.headers.end() ? nullptr : &found->second;
}

std::string_view without_weakness(std::string_view tag) {
  if (tag.substr(0, 2) == "W/") tag.remove_prefix(2);
  return tag;
}

/// Whether the list of entity tags, or *, names this one (weak comparison).
bool names(std::string_view list, std::string_view tag) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view entry = trimmed(list.substr(0, comma));
    if (entry == "*" || without_weakness(entry) == without_weakness(tag)) return true;
    list.remove_prefix(std::min(list.size(), comma + 1));
  }
  return false;
}

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

struct ByteRange {
  std::uint64_t first = 0, last = 0;
};

/// What a Range header means for a body of `length` bytes.
struct RangeWish {
  enum class Kind { none, range, unsatisfiable } kind = Kind::none;
  ByteRange range;
};

RangeWish read_suffix(std::string_view digits, std::uint64_t length) {
  const auto count = number_in(digits);
  if (!count) return {};
  if (*count == 0 || length == 0) return {RangeWish::Kind::unsatisfiable, {}};
  return {RangeWish::Kind::range, {length - std::min(*count, length), length - 1}};
}

RangeWish read_range(std::string_view text, std::uint64_t length) {
  constexpr std::string_view kUnit = "bytes=";
  if (lower_case(text.substr(0, kUnit.size())) != kUnit) return {};
  text = trimmed(text.substr(kUnit.size()));
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return {};
  if (dash == 0) return read_suffix(text.substr(1), length);
  const auto first = number_in(text.substr(0, dash));
  const std::string_view end = text.substr(dash + 1);
  const auto last = end.empty() ? std::optional(UINT64_MAX) : number_in(end);
  if (!first || !last || *last < *first) return {};
  if (*first >= length) return {RangeWish::Kind::unsatisfiable, {}};
  return {RangeWish::Kind::range, {*first, std::min(*last, length - 1)}};
}

/// A stream from `skip` on: what lies before is pulled and thrown away.
class TailStream final : public ByteStream {
 public:
  TailStream(std::unique_ptr<ByteStream> whole, std::uint64_t skip) : whole_(std::move(whole)), skip_(skip) {}

  Result<Pulled> pull(std::span<std::byte> into) override {
    if (skip_ == 0) return whole_->pull(into);
    const auto room = static_cast<std::size_t>(std::min<std::uint64_t>(skip_, into.size()));
    auto pulled = whole_->pull(into.first(room));
    if (!pulled || pulled->state != Pulled::State::data) return pulled;
    skip_ -= pulled->count;
    return Pulled{Pulled::State::data, 0};
  }
  void on_ready(std::function<void()> bell) override { whole_->on_ready(std::move(bell)); }

 private:
  std::unique_ptr<ByteStream> whole_;
  std::uint64_t skip_;
};

void keep_range(Reply& reply, const ByteRange& range, std::uint64_t length) {
  const std::uint64_t count = range.last - range.first + 1;
  reply.status = 206;
  reply.headers.emplace_back("Content-Range", "bytes " + std::to_string(range.first) + "-" +
                                                  std::to_string(range.last) + "/" + std::to_string(length));
  if (!reply.stream) {
    const std::string& whole = reply.shared ? *reply.shared : reply.body;
    std::string kept = whole.substr(static_cast<std::size_t>(range.first), static_cast<std::size_t>(count));
    reply.body = std::move(kept);
    reply.shared.reset();
    return;
  }
  reply.stream = std::make_unique<TailStream>(std::move(reply.stream), range.first);
  reply.length = count;
}

/// Without If-Range, or with one that names exactly the reply's strong tag.
bool may_be_ranged(const Request& request, const std::string* tag) {
  const std::string* condition = request.header("if-range");
  return !condition || (tag && *condition == *tag && tag->substr(0, 2) != "W/");
}

}  // namespace

void apply_conditions(const Request& request, Reply& reply) {
  if ((request.method != "GET" && request.method != "HEAD") || reply.status != 200) return;
  const std::string* tag = find_header(reply, "etag");
  const std::string* known = request.header("if-none-match");
  if (tag && known && names(*known, *tag)) {
    reply.status = 304;
    reply.body.clear();
    reply.shared.reset();
    reply.stream.reset();
    return;
  }
  if (reply.stream && !reply.length) return;
  const std::uint64_t length = body_length(reply);
  const bool is_ranged = may_be_ranged(request, tag);
  reply.headers.emplace_back("Accept-Ranges", "bytes");
  const std::string* text = request.header("range");
  if (!text || request.method != "GET" || !is_ranged) return;
  const RangeWish wish = read_range(*text, length);
  if (wish.kind == RangeWish::Kind::range) keep_range(reply, wish.range, length);
  if (wish.kind != RangeWish::Kind::unsatisfiable) return;
  reply = refusal_reply({416, "the range lies behind the end"});
  reply.headers.emplace_back("Content-Range", "bytes */" + std::to_string(length));
}

}  // namespace geosis::server::http
