#pragma once

#include "engine/base/result.h"
#include "engine/mesh/vertex_attributes.h"

namespace geosis {

/// visit(name, member) -> Result<void> for each array of VertexAttributes that holds one number a vertex, in the order
/// in which files carry them; stops at the first error. What is done to all arrays alike is written once, for a pointer
/// to member.
template <class Visit>
Result<void> visit_numbers(const Visit& visit) {
  if (auto done = visit("reliability", &VertexAttributes::reliability); !done) return done;
  if (auto done = visit("body", &VertexAttributes::body); !done) return done;
  if (auto done = visit("value", &VertexAttributes::value); !done) return done;
  return visit("agreement", &VertexAttributes::agreement);
}

/// visit(name, member) -> Result<void> for every array.
template <class Visit>
Result<void> visit_arrays(const Visit& visit) {
  if (auto done = visit_numbers(visit); !done) return done;
  return visit("normal", &VertexAttributes::normal);
}

/// visit(name, member) for each array of numbers, where nothing can fail.
template <class Visit>
void for_each_number(const Visit& visit) {
  (void)visit_numbers([&](const char* name, auto array) -> Result<void> {
    visit(name, array);
    return {};
  });
}

/// visit(name, member) for every array, where nothing can fail.
template <class Visit>
void for_each_array(const Visit& visit) {
  (void)visit_arrays([&](const char* name, auto array) -> Result<void> {
    visit(name, array);
    return {};
  });
}

}  // namespace geosis
