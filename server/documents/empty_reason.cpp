#include "server/documents/empty_reason.h"

namespace geosis::server {
namespace {

const char* code_of(EmptyReason reason) {
  switch (reason) {
    case EmptyReason::nothing_in_range:
      return "nothing_in_range";
    case EmptyReason::no_surface:
      return "no_surface";
    case EmptyReason::no_seeded_body:
      return "no_seeded_body";
    case EmptyReason::too_small:
      return "too_small";
  }
  return "";
}

}  // namespace

const char* text_of(EmptyReason reason) {
  switch (reason) {
    case EmptyReason::nothing_in_range:
      return "Nothing lies in the range.";
    case EmptyReason::no_surface:
      return "The range has no surface here: without a cap, what lies wholly inside it has none.";
    case EmptyReason::no_seeded_body:
      return "No body contains a seed.";
    case EmptyReason::too_small:
      return "Every body that could be kept is smaller than min_voxels.";
  }
  return "";
}

Json empty_reason_document(const std::optional<EmptyReason>& reason) {
  if (!reason) return nullptr;
  return {{"code", code_of(*reason)}, {"detail", text_of(*reason)}};
}

}  // namespace geosis::server
