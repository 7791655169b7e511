#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>

#include "engine/base/result.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// Reads the members of a JSON object strictly: a member that nobody asked for, or one of another type than asked for,
/// is a problem, told with its JSON pointer. The first problem sticks in `problem`; what is read after it has no
/// meaning.
///
///     std::optional<Error> problem;
///     ObjectReader request(json, "", problem);
///     bool cap = request.boolean("cap", true);
///     request.refuse_unknown();
///     if (problem) return *problem;
class ObjectReader {
 public:
  /// value     must outlive the reader; when it is not an object, that is the problem.
  /// pointer   where value is in its document, "" for the whole document.
  ObjectReader(const Json& value, std::string pointer, std::optional<Error>& problem);

  /// The member, or nullptr when it is absent.
  const Json* find(const char* name);
  bool boolean(const char* name, bool otherwise);
  /// A whole number in [min, max]; nullopt when absent or null.
  std::optional<std::int64_t> whole_number(const char* name, std::int64_t min, std::int64_t max);
  /// Position of the member's string among the choices; 0 when absent.
  int choice(const char* name, std::initializer_list<const char*> choices);
  /// To be called last.
  void refuse_unknown();

  std::string pointer_to(const char* name) const { return pointer_ + "/" + name; }
  /// Notes that the member's value is not what was expected ("a number in (0, 1]").
  void refuse(const std::string& pointer, const Json& value, const std::string& expected);

 private:
  void note(ErrorCode code, std::string message);

  const Json& value_;
  std::string pointer_;
  std::optional<Error>& problem_;
  std::set<std::string> known_;
};

/// A whole number in [min, max], also when written as 3.0; nullopt for anything else.
std::optional<std::int64_t> whole_number_of(const Json& value, std::int64_t min, std::int64_t max);

}  // namespace geosis::server
