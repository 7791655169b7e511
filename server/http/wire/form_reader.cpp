#include "server/http/wire/form_reader.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace geosis::server::http {
namespace {

constexpr std::size_t kPiece = 1 << 18;
constexpr std::size_t kLongestHead = 1 << 13, kLongestText = 1 << 16;
constexpr std::size_t kMostFields = 16;

Error malformed(const char* what) {
  return {ErrorCode::malformed_input, std::string("form: ") + what};
}

/// Part of the body in memory, refilled from the reader; bytes before `start` are done with.
class Window {
 public:
  explicit Window(BodyReader& body) : body_(body) {}

  std::string_view rest() const { return std::string_view(bytes_).substr(start_); }
  void skip(std::size_t count) { start_ += count; }
  /// False at the end of the body.
  Result<bool> fill() {
    bytes_.erase(0, std::exchange(start_, 0));
    const std::size_t before = bytes_.size();
    bytes_.resize(before + kPiece);
    const auto count = body_.read(std::as_writable_bytes(std::span(bytes_).subspan(before)));
    bytes_.resize(before + (count ? *count : 0));
    if (!count) return count.error();
    return *count > 0;
  }

 private:
  BodyReader& body_;
  std::string bytes_;
  std::size_t start_ = 0;
};

/// Hands everything before the delimiter to `take` and skips the delimiter. Holds back no more than a delimiter.
Result<void> read_until(Window& window, std::string_view delimiter,
                        const std::function<Result<void>(std::string_view)>& take) {
  for (;;) {
    const std::size_t found = window.rest().find(delimiter);
    const bool is_complete = found != std::string_view::npos;
    const std::size_t held = delimiter.size() - 1;
    const std::size_t ready = is_complete ? found : window.rest().size() - std::min(window.rest().size(), held);
    if (ready > 0) {
      if (auto taken = take(window.rest().substr(0, ready)); !taken) return taken;
    }
    window.skip(ready + (is_complete ? delimiter.size() : 0));
    if (is_complete) return {};
    const auto more = window.fill();
    if (!more) return more.error();
    if (!*more) return malformed("the body ends inside a part");
  }
}

Result<std::string> read_text(Window& window, std::string_view delimiter, std::size_t longest) {
  std::string text;
  const auto done = read_until(window, delimiter, [&](std::string_view piece) -> Result<void> {
    if (text.size() + piece.size() > longest) {
      return Error{ErrorCode::limit_exceeded,
                   "form: a field or head is longer than " + std::to_string(longest) + " bytes"};
    }
    text += piece;
    return {};
  });
  if (!done) return done.error();
  return text;
}

/// The value of name="..." in a Content-Disposition line.
std::optional<std::string> quoted_value(std::string_view line, std::string_view name) {
  const std::string key = "; " + std::string(name) + "=\"";
  const std::size_t start = line.find(key);
  if (start == std::string_view::npos) return std::nullopt;
  const std::size_t end = line.find('"', start + key.size());
  if (end == std::string_view::npos) return std::nullopt;
  return std::string(line.substr(start + key.size(), end - start - key.size()));
}

struct PartHead {
  std::string name;
  std::optional<std::string> file_name;
};

Result<PartHead> parse_head(std::string_view head) {
  while (!head.empty()) {
    const std::size_t end = std::min(head.find("\r\n"), head.size());
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 2, head.size()));
    constexpr std::string_view kDisposition = "content-disposition:";
    std::string start(line.substr(0, kDisposition.size()));
    std::transform(start.begin(), start.end(), start.begin(), [](unsigned char c) { return std::tolower(c); });
    if (start != kDisposition) continue;
    const auto name = quoted_value(line, "name");
    if (!name) return malformed("a part without a name");
    return PartHead{*name, quoted_value(line, "filename")};
  }
  return malformed("a part without Content-Disposition");
}

Result<void> read_part(Window& window, std::string_view delimiter, const FileSink& sink, FormFields& fields) {
  const auto head_text = read_text(window, "\r\n\r\n", kLongestHead);
  if (!head_text) return head_text.error();
  auto head = parse_head(*head_text);
  if (!head) return std::move(head).error();
  if (head->name != "file") {
    if (fields.text.size() >= kMostFields) return Error{ErrorCode::limit_exceeded, "form: too many fields"};
    auto text = read_text(window, delimiter, kLongestText);
    if (!text) return std::move(text).error();
    fields.text[head->name] = *std::move(text);
    return {};
  }
  if (std::exchange(fields.has_file, true)) return malformed("more than one file");
  fields.file_name = head->file_name.value_or("");
  return read_until(window, delimiter, [&](std::string_view piece) { return sink(std::as_bytes(std::span(piece))); });
}

}  // namespace

std::optional<std::string> form_boundary(const std::string& content_type) {
  constexpr std::string_view kType = "multipart/form-data";
  if (!content_type.starts_with(kType)) return std::nullopt;
  const std::size_t start = content_type.find("boundary=");
  if (start == std::string::npos) return std::nullopt;
  std::string boundary = content_type.substr(start + 9);
  boundary = boundary.substr(0, boundary.find(';'));
  if (boundary.size() >= 2 && boundary.front() == '"' && boundary.back() == '"')
    boundary = boundary.substr(1, boundary.size() - 2);
  if (boundary.empty() || boundary.size() > 70) return std::nullopt;
  return boundary;
}

Result<FormFields> read_form(BodyReader& body, const std::string& boundary, const FileSink& sink) {
  Window window(body);
  FormFields fields;
  const std::string delimiter = "\r\n--" + boundary;
  // The first boundary has no line before it, unless there is a preamble, which nobody sends.
  if (auto first = read_text(window, "--" + boundary, kLongestHead); !first) return std::move(first).error();
  for (;;) {
    while (window.rest().size() < 2) {
      const auto more = window.fill();
      if (!more) return more.error();
      if (!*more) return malformed("the body ends after a boundary");
    }
    const std::string next(window.rest().substr(0, 2));
    window.skip(2);
    if (next == "--") return fields;
    if (next != "\r\n") return malformed("a boundary that does not end its line");
    if (auto read = read_part(window, delimiter, sink, fields); !read) return std::move(read).error();
  }
}

}  // namespace geosis::server::http
