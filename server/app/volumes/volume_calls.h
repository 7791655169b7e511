#pragma once

#include <memory>
#include <string>

#include "engine/analysis/histogram.h"
#include "server/app/services.h"

namespace geosis::server {

// Calls about one volume that take more than one use case.

inline constexpr int kDefaultPage = 100, kLargestPage = 1000;  ///< volumes in one answer
inline constexpr int kDefaultHistogramBins = 256;

/// The volume's document, or how its import goes. errors: not_found, internal.
Result<Json> show_volume(const Services& services, const std::string& id);

/// Removes a volume and all that was derived from it, or an import that has ended. errors: not_found; already_exists:
/// the import goes on.
Result<void> remove_volume(const Services& services, const std::string& id);

/// Begins to count; `counted` holds the result once the job is done. errors: those of the queue.
Result<std::shared_ptr<Job>> begin_histogram(const Services& services, const std::string& id, int bins,
                                             std::shared_ptr<Histogram> counted);

}  // namespace geosis::server
