#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/app/extractions/extractions.h"
#include "server/app/volumes/volumes.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server::test {

/// A raw file of 20 x 20 x 20 float32 samples, a ball of the given radius where they are >= 0.
std::vector<std::byte> ball_file(double radius);
UploadOptions ball_options();

/// The use cases over one store, as a server has them.
struct Service {
  explicit Service(BlobStore& blobs, ReconstructFunction reconstruct = geosis::reconstruct, int workers = 2,
                   WatchTiming timing = {})
      : store(blobs),
        volumes(blobs, "default", 1),
        queue(workers, 16),
        extractions(blobs, volumes, queue, "default", 1, std::move(reconstruct), timing) {}

  ~Service() { queue.stop(); }

  /// Uploads a ball; its volume id.
  std::string add_ball(double radius = 7);

  BlobStore& store;
  Volumes volumes;
  JobQueue queue;
  Extractions extractions;
};

/// {"range": [0, null]}
Json ball_request();

/// Lets a reconstruction come to one level and no further until it is opened.
class Gate {
 public:
  void open() { is_open_.store(true); }
  void wait(Progress& progress) {
    has_arrived_ = true;
    while (!is_open_ && !progress.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  bool has_arrived() const { return has_arrived_; }

 private:
  std::atomic<bool> is_open_{false}, has_arrived_{false};
};

/// reconstruct() that stops at the gate once level `level` is encoded, before the finer ones are.
inline ReconstructFunction gated_after(int level, Gate& gate) {
  return [level, &gate](const ReconstructInput& input, const ReconstructOptions& options, Progress& progress,
                        StageTimings* timings, const LevelSink& sink) {
    const LevelSink gated = [&](std::size_t number, const ReconstructedLevel& done) {
      sink(number, done);
      if (static_cast<int>(number) == level) gate.wait(progress);
    };
    return reconstruct(input, options, progress, timings, gated);
  };
}

template <class Condition>
bool comes_true(const Condition& condition) {
  for (int n = 0; n < 10000; ++n) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// Everything that a stream gives until it ends, waiting for its bell where it has nothing yet. An error ends the text
/// with its code in braces.
std::string read_all(ByteStream& stream);

}  // namespace geosis::server::test
