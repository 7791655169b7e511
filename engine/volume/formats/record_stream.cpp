#include "engine/volume/formats/record_stream.h"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/digest.h"
#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr std::uint64_t kBatchBytes = 16 << 20;

Error cancelled() {
  return {ErrorCode::cancelled, "cancelled"};
}

// Hashes the bytes [begin, end) of the file.
Result<void> digest_range(const ByteSource& source, std::uint64_t begin, std::uint64_t end, Sha256& digest,
                          Progress& progress) {
  std::vector<std::byte> buffer(std::min(kBatchBytes, end - begin));
  while (begin < end) {
    if (progress.cancelled()) return cancelled();
    const std::span<std::byte> bytes = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), end - begin));
    if (auto read = source.read_at(begin, bytes); !read) return read;
    digest.update(bytes);
    begin += bytes.size();
  }
  return {};
}

class RecordStream {
 public:
  RecordStream(const ByteSource& source, const Records& records, const RecordVisitor& visitor, int threads)
      : source_(source),
        records_(records),
        visitor_(visitor),
        threads_(threads),
        per_batch_(std::max<std::uint64_t>(1, kBatchBytes / records.bytes)),
        outcomes_(visitor.parts) {}

  Result<void> run(Sha256& digest, Progress& progress) {
    auto batch = read(0, buffers_[0]);
    for (int turn = 1; batch && batch->count > 0; turn = 1 - turn) {
      if (progress.cancelled()) return cancelled();
      if (visitor_.in_order) visitor_.in_order(*batch);
      batch = work_and_read_ahead(*batch, buffers_[turn], digest);
      for (Result<void>& outcome : outcomes_)
        if (!outcome) return std::move(outcome).error();
      if (batch) progress.report("import", static_cast<double>(batch->first) / static_cast<double>(records_.count));
    }
    if (!batch) return std::move(batch).error();
    return {};
  }

 private:
  Result<RecordBatch> read(std::uint64_t first, std::vector<std::byte>& buffer) const {
    const std::uint64_t count = std::min(per_batch_, records_.count - first);
    buffer.resize(count * records_.bytes);
    if (auto got = source_.read_at(records_.begin + first * records_.bytes, buffer); !got)
      return std::move(got).error();
    return RecordBatch{first, count, buffer};
  }

  // Reading may wait for a network: no thread that computes does it.
  Result<RecordBatch> work_and_read_ahead(const RecordBatch& batch, std::vector<std::byte>& buffer, Sha256& digest) {
    const std::jthread worker([&] { work(batch, digest); });
    return read(batch.first + batch.count, buffer);
  }

  void work(const RecordBatch& batch, Sha256& digest) {
    parallel_for(visitor_.parts + 1, threads_, [&](std::size_t task) {
      if (task == 0)
        digest.update(batch.bytes);
      else
        outcomes_[task - 1] = visitor_.in_parts(batch, task - 1);
    });
  }

  const ByteSource& source_;
  const Records records_;
  const RecordVisitor& visitor_;
  const int threads_;
  const std::uint64_t per_batch_;
  std::vector<Result<void>> outcomes_;  ///< of the parts of one batch
  std::vector<std::byte> buffers_[2];
};

}  // namespace

RecordBatch share_of(const RecordBatch& batch, std::size_t part, std::size_t parts) {
  const std::uint64_t begin = batch.count * part / parts, end = batch.count * (part + 1) / parts;
  const std::uint64_t bytes = batch.count == 0 ? 0 : batch.bytes.size() / batch.count;
  return {batch.first + begin, end - begin, batch.bytes.subspan(begin * bytes, (end - begin) * bytes)};
}

Result<std::string> stream_records(const ByteSource& source, const Records& records, const RecordVisitor& visitor,
                                   int threads, Progress& progress) {
  Sha256 digest;
  if (auto done = digest_range(source, 0, records.begin, digest, progress); !done) return std::move(done).error();
  if (auto done = RecordStream(source, records, visitor, threads).run(digest, progress); !done)
    return std::move(done).error();
  const std::uint64_t end = records.begin + records.count * records.bytes;
  if (auto done = digest_range(source, end, source.size(), digest, progress); !done) return std::move(done).error();
  return std::move(digest).hex();
}

}  // namespace geosis
