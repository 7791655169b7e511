#pragma once

#include <string>

#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/reconstruct.h"

namespace geosis::server {

/// The certificates of all levels as a table for people, one line a level.
std::string level_table(const Reconstruction& reconstruction);

/// The largest bodies, one line each; empty when there are none.
std::string body_table(const std::vector<DescribedBody>& bodies);

}  // namespace geosis::server
