#include "server/log/log.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

#include <spdlog/async.h>
#include <spdlog/async_logger.h>
#include <spdlog/sinks/stdout_sinks.h>

namespace geosis::server {
namespace {

constexpr std::size_t kWaitingLines = 8192;

const char* name_of(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return "debug";
    case LogLevel::info:
      return "info";
    case LogLevel::warning:
      return "warning";
    case LogLevel::error:
      return "error";
  }
  return "error";
}

std::string now_text() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto since = now.time_since_epoch() % std::chrono::seconds(1);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::array<char, 8> thousandths{};
  std::snprintf(thousandths.data(), thousandths.size(), ".%03dZ",
                static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(since).count()));
  return std::string(text.data()) + thousandths.data();
}

/// A JSON string. Bytes beyond ASCII go as escapes of Latin-1: what clients send need not be UTF-8.
std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte >= 0x7f) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", unsigned{byte});
      result += escape.data();
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// As it is where it cannot be misread.
std::string quoted_if_needed(std::string_view text) {
  for (const char c : text) {
    if (c <= ' ' || c >= '\x7f' || c == '"' || c == '\\' || c == '=') return quoted(text);
  }
  return text.empty() ? "\"\"" : std::string(text);
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string value_text(const LogField& field, LogFormat format) {
  if (const auto* text = std::get_if<std::string>(&field.value)) {
    return format == LogFormat::json ? quoted(*text) : quoted_if_needed(*text);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&field.value)) return std::to_string(*whole);
  return number_text(std::get<double>(field.value));
}

}  // namespace

std::string log_line(LogFormat format, std::string_view time, LogLevel level, std::string_view message,
                     const std::vector<LogField>& fields) {
  std::string line;
  if (format == LogFormat::json) {
    line.append("{\"time\":").append(quoted(time)).append(",\"level\":\"").append(name_of(level));
    line.append("\",\"message\":").append(quoted(message));
    for (const LogField& field : fields) {
      line.append(",").append(quoted(field.name)).append(":").append(value_text(field, format));
    }
    return line + "}";
  }
  const std::string quoted_message = quoted(message);
  line.append(time).append(" ").append(name_of(level)).append(" ");
  line.append(quoted_message, 1, quoted_message.size() - 2);
  for (const LogField& field : fields)
    line.append(" ").append(field.name).append("=").append(value_text(field, format));
  return line;
}

class Log::Sink {
 public:
  Sink()
      : threads_(std::make_shared<spdlog::details::thread_pool>(kWaitingLines, 1)),
        logger_(std::make_shared<spdlog::async_logger>("geosis", std::make_shared<spdlog::sinks::stderr_sink_mt>(),
                                                       threads_, spdlog::async_overflow_policy::overrun_oldest)) {
    logger_->set_pattern("%v");
    logger_->set_level(spdlog::level::trace);
  }
  void write(const std::string& line) { logger_->log(spdlog::level::info, line); }

 private:
  std::shared_ptr<spdlog::details::thread_pool> threads_;  // its end writes what waits
  std::shared_ptr<spdlog::async_logger> logger_;
};

Log::Log(LogFormat format, LogLevel least) : format_(format), least_(least), sink_(std::make_unique<Sink>()) {}
Log::~Log() = default;

void Log::write(LogLevel level, std::string_view message, const std::vector<LogField>& fields) {
  if (level < least_) return;
  sink_->write(log_line(format_, now_text(), level, message, fields));
}

}  // namespace geosis::server
