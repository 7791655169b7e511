#pragma once

#include <string>

#include "engine/pipeline/reconstruct.h"

namespace geosis::server {

/// The certificates of all levels as a table for people, one line a level.
std::string level_table(const Reconstruction& reconstruction);

}  // namespace geosis::server
