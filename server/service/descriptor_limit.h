#pragma once

#include <cstddef>

namespace geosis::server {

/// Raises the number of descriptors that this process may hold as far as it is allowed to. returns that number.
std::size_t raise_descriptor_limit();

}  // namespace geosis::server
