#pragma once

#include <cstddef>
#include <string>

#include <google/protobuf/message.h>

#include "engine/base/result.h"
#include "server/documents/json_text.h"

namespace geosis::server::rpc {

// The messages of api/proto mirror the documents of the HTTP calls name by name, so one walk over a message's fields is
// the codec of all of them. Where they differ:
//
//   [low, high], [i, j, k] ...     a message with one field for each element, in order (Range, Node, Dims, Point ...)
//   null                           a field that is not set; an error_cap of null, which means none, is infinity
//   "queued", "2026-01-31T..."     values of enums (EXTRACTION_STATE_QUEUED), timestamps
//   url, links                     HTTP's own: no field has their names

/// Sets the fields that the document has members for; others stay. Text becomes valid UTF-8.
void set_message(google::protobuf::Message& message, const Json& document);

/// The document of a message from outside: what is not set is left out, and has its default there.
///
/// errors   invalid_argument: a number that is none (NaN), a field that this version does not know, an enum's value
///          that has no name; with the field's pointer.
Result<Json> document_of(const google::protobuf::Message& message);

/// Text of at most so many bytes, cut between characters.
std::string shortened(std::string text, std::size_t most);

}  // namespace geosis::server::rpc
