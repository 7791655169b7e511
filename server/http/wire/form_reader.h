#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// The boundary of a multipart/form-data Content-Type; nullopt for any other type.
std::optional<std::string> form_boundary(const std::string& content_type);

/// Takes the bytes of the form's file as they arrive.
using FileSink = std::function<Result<void>(std::span<const std::byte>)>;

/// What a form holds beside its file.
struct FormFields {
  std::map<std::string, std::string> text;  ///< field name -> value, at most 16 of 64 KiB each
  std::string file_name;                    ///< as the client calls it
  bool has_file = false;
};

/// Reads a multipart/form-data body (RFC 7578): the field `file` goes to the sink piece by piece, whatever its size.
///
/// errors   malformed_input: not a form, cut short, more than one file; limit_exceeded: a text field or head that is
///          too long; those of the reader and the sink.
Result<FormFields> read_form(BodyReader& body, const std::string& boundary, const FileSink& sink);

}  // namespace geosis::server::http
