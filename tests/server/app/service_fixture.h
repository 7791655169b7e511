#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/app/extractions.h"
#include "server/app/volumes.h"
#include "server/jobs/job_queue.h"
#include "server/store/blob_store.h"

namespace geosis::server::test {

/// A raw file of 20 x 20 x 20 float32 samples, a ball of the given radius where they are >= 0.
std::vector<std::byte> ball_file(double radius);
UploadOptions ball_options();

/// The use cases over one store, as a server has them.
struct Service {
  explicit Service(BlobStore& blobs, ReconstructFunction reconstruct = geosis::reconstruct, int workers = 2)
      : store(blobs),
        volumes(blobs, "default", 1),
        queue(workers, 16),
        extractions(blobs, volumes, queue, "default", 1, std::move(reconstruct)) {}

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

/// Everything that a stream gives until it ends, waiting for its bell where it has nothing yet. An error ends the text
/// with its code in braces.
std::string read_all(ByteStream& stream);

}  // namespace geosis::server::test
