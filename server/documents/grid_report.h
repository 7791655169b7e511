#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// {"period", "inline": {"median", "p95", "p99"}, "crossline": {...}, "warped"}: dips in samples a trace.
Json dips_document(const DipReport& dips);

/// What dips_document made. errors: malformed_input.
Result<DipReport> parse_dips_document(const Json& document);

/// Whether so slow a period is none: it does not fit into a trace of so many samples.
bool is_beyond_trace(const DipReport& dips, std::int32_t samples);

/// What `grid: auto` chooses for such dips, and why, in one sentence.
///
/// samples   of a trace, where people read the sentence; a manifest's says the same whatever the trace.
struct GridDecision {
  bool is_structural = false;
  std::string because;
};
GridDecision decide_grid(const DipReport& dips, std::optional<std::int32_t> samples = std::nullopt);

/// The manifest's "grid": what was asked for, what was chosen and why, and how far it is to be trusted.
Json grid_document(GridChoice asked, const GridReport& report);

/// The same for a grid that somebody has stored.
///
/// lattice_step   of positions, in the world; nullopt in index space.
Json placed_grid_document(const std::string& id, const NodeReport& nodes, std::optional<double> lattice_step);

const char* name_of(GridChoice choice);

}  // namespace geosis::server
