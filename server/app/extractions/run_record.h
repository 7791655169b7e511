#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/result.h"
#include "server/app/extractions/extraction_blobs.h"
#include "server/documents/json_text.h"
#include "server/store/blob_store.h"

namespace geosis::server {

/// What processes tell each other about an extraction that is not done: who wants it, who computes it, how far that is.
struct RunRecord {
  enum class State { wanted, cancelled, failed };

  State state = State::wanted;
  int interest = 0;            ///< POSTs that were not withdrawn
  std::string owner;           ///< the run that has the lease, "<process>.<number>"; "" = nobody
  std::uint64_t beat = 0;      ///< raised by the owner as long as it lives
  std::int64_t lease_ms = 0;   ///< an owner whose beat stands still for so long has lost the lease
  std::size_t levels = 0;      ///< that are told of in levels.json
  std::string stage;           ///< as the owner last said
  double progress = 0;         ///< of the stage
  std::optional<Error> error;  ///< of a failed run

  /// Takes interests away; without any left it is cancelled.
  void withdraw(int interests) {
    interest = std::max(0, interest - interests);
    if (interest == 0 && state == State::wanted) state = State::cancelled;
  }
};

/// Run records in the store, one for each extraction: <tenant>/extractions/<id>/run.json, changed by put_if alone. No
/// record is an empty one: wanted, by nobody in particular.
class RunRecords {
 public:
  RunRecords(BlobStore& store, std::string tenant) : store_(store), tenant_(std::move(tenant)) {}

  /// One that is damaged is taken for none: it is a convenience but for a cancellation.
  ///
  /// errors   unavailable.
  Result<RunRecord> read(const std::string& id) const;
  /// Changes a record as if nobody else did at the same time. change() returns false to leave it as it is, and may be
  /// called several times.
  ///
  /// returns  the record as it is afterwards.  errors: no_space, unavailable.
  Result<RunRecord> update(const std::string& id, const std::function<bool(RunRecord&)>& change);
  Result<void> remove(const std::string& id) { return store_.remove(key(id)); }

 private:
  struct Seen {
    RunRecord record;
    std::string version;
  };
  BlobKey key(const std::string& id) const { return tenant_ + "/extractions/" + id + "/" + kRun; }
  Result<Seen> look(const std::string& id) const;

  BlobStore& store_;
  const std::string tenant_;
};

}  // namespace geosis::server
