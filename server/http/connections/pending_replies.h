#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "server/app/extractions/extraction.h"
#include "server/http/routing/exchange.h"
#include "server/jobs/job.h"

namespace geosis::server::http {

/// What happens to a job when the client that waits for it goes away.
enum class WhenAbandoned { cancel, run_on };

/// The answer that a job ends with: its error, or what `answer` makes of it.
Reply after_job(Result<std::shared_ptr<Job>> job, WhenAbandoned abandoned, std::function<Reply()> answer);

/// What `answer` says once the extraction has ended, at the latest after `time`, and sooner when the server stops.
Reply after_extraction(std::shared_ptr<Extraction> extraction, std::chrono::seconds time,
                       std::function<Reply(const Extraction&)> answer);

}  // namespace geosis::server::http
