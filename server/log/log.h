#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace geosis::server {

enum class LogFormat { text, json };
enum class LogLevel { debug, info, warning, error };

/// One thing that a line tells beside its message.
struct LogField {
  const char* name;
  std::variant<std::string, std::int64_t, double> value;
};

/// A line without its end: "2026-01-31T12:00:00.123Z info message name=value ..." or a JSON object with time, level,
/// message and the fields. Whatever the values hold, it is one line.
std::string log_line(LogFormat format, std::string_view time, LogLevel level, std::string_view message,
                     const std::vector<LogField>& fields);

/// Lines on stderr, written by a thread of their own: whoever writes never waits for who reads, and when too many wait
/// the oldest are dropped. Any thread may call any member.
class Log {
 public:
  Log(LogFormat format, LogLevel least);
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  ~Log();  ///< writes what waits

  void write(LogLevel level, std::string_view message, const std::vector<LogField>& fields = {});

 private:
  class Sink;

  const LogFormat format_;
  const LogLevel least_;
  std::unique_ptr<Sink> sink_;
};

}  // namespace geosis::server
