#include "server/http/wire/reply_head.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

#include "server/http/wire/head_parser.h"

namespace geosis::server::http {
namespace {

struct StatusPhrase {
  int status;
  const char* phrase;
};

constexpr StatusPhrase kPhrases[] = {{200, "OK"},
                                     {201, "Created"},
                                     {202, "Accepted"},
                                     {204, "No Content"},
                                     {206, "Partial Content"},
                                     {303, "See Other"},
                                     {304, "Not Modified"},
                                     {400, "Bad Request"},
                                     {401, "Unauthorized"},
                                     {403, "Forbidden"},
                                     {404, "Not Found"},
                                     {405, "Method Not Allowed"},
                                     {406, "Not Acceptable"},
                                     {408, "Request Timeout"},
                                     {409, "Conflict"},
                                     {410, "Gone"},
                                     {411, "Length Required"},
                                     {412, "Precondition Failed"},
                                     {413, "Content Too Large"},
                                     {414, "URI Too Long"},
                                     {415, "Unsupported Media Type"},
                                     {416, "Range Not Satisfiable"},
                                     {417, "Expectation Failed"},
                                     {422, "Unprocessable Content"},
                                     {429, "Too Many Requests"},
                                     {431, "Request Header Fields Too Large"},
                                     {499, "Client Closed Request"},
                                     {500, "Internal Server Error"},
                                     {501, "Not Implemented"},
                                     {503, "Service Unavailable"},
                                     {504, "Gateway Timeout"},
                                     {505, "HTTP Version Not Supported"},
                                     {507, "Insufficient Storage"}};

/// RFC 9110's IMF-fixdate, whatever the process's locale says about the names of days.
std::string date_text() {
  constexpr std::array<const char*, 7> kDays = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array<const char*, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                   "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "%d %%s %Y %H:%M:%S GMT", &utc);
  std::string date(text.data());
  date.replace(date.find("%s"), 2, kMonths[static_cast<std::size_t>(utc.tm_mon)]);
  return std::string(kDays[static_cast<std::size_t>(utc.tm_wday)]) + ", " + date;
}

bool belongs_to_the_writer(std::string_view name) {
  const std::string lower = lower_case(name);
  return lower == "content-length" || lower == "transfer-encoding" || lower == "connection" || lower == "date";
}

}  // namespace

bool is_writable(const Reply& reply) {
  if (reply.status < 200 || reply.status > 599) return false;
  return std::all_of(reply.headers.begin(), reply.headers.end(), [](const auto& header) {
    return is_token(header.first) && is_field_value(header.second) && !belongs_to_the_writer(header.first);
  });
}

bool is_bodiless(int status) {
  return status == 204 || status == 304;
}

std::uint64_t body_length(const Reply& reply) {
  if (reply.stream) return reply.length.value_or(0);
  return reply.shared ? reply.shared->size() : reply.body.size();
}

std::string reply_head(const Reply& reply, const ReplyForm& form) {
  std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " " + status_phrase(reply.status) + "\r\n";
  const auto add = [&head](std::string_view name, std::string_view value) {
    head.append(name).append(": ").append(value).append("\r\n");
  };
  for (const auto& [name, value] : reply.headers) add(name, value);
  add("Date", date_text());
  if (!is_bodiless(reply.status)) {
    if (reply.stream && !reply.length) {
      add("Transfer-Encoding", "chunked");
    } else {
      add("Content-Length", std::to_string(body_length(reply)));
    }
  }
  if (form.closes) add("Connection", "close");
  return head += "\r\n";
}

const char* status_phrase(int status) {
  const auto* found = std::find_if(std::begin(kPhrases), std::end(kPhrases),
                                   [status](const StatusPhrase& phrase) { return phrase.status == status; });
  return found == std::end(kPhrases) ? "" : found->phrase;
}

}  // namespace geosis::server::http
