#include "engine/volume/formats/record_stream.h"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/digest.h"
#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr std::uint64_t kBatchBytes = 8 << 20;
constexpr std::uint64_t kPieceBytes = 256 << 10;

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
        per_piece_(std::max<std::uint64_t>(1, kPieceBytes / records.bytes)) {}

  Result<void> run(Sha256& digest, Progress& progress) {
    auto batch = read(0, buffers_[0]);
    for (int turn = 1; batch && batch->count > 0; turn = 1 - turn) {
      if (progress.cancelled()) return cancelled();
      visitor_.in_order(*batch);
      batch = work_and_read_ahead(*batch, buffers_[turn], digest);
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

  RecordBatch piece_of(const RecordBatch& batch, std::uint64_t piece) const {
    const std::uint64_t begin = piece * per_piece_, count = std::min(per_piece_, batch.count - begin);
    return {batch.first + begin, count, batch.bytes.subspan(begin * records_.bytes, count * records_.bytes)};
  }

  // Reading may wait for a network: no thread that computes does it.
  Result<RecordBatch> work_and_read_ahead(const RecordBatch& batch, std::vector<std::byte>& buffer, Sha256& digest) {
    const std::jthread worker([&] { work(batch, digest); });
    return read(batch.first + batch.count, buffer);
  }

  void work(const RecordBatch& batch, Sha256& digest) const {
    const std::uint64_t pieces = (batch.count + per_piece_ - 1) / per_piece_;
    parallel_for(pieces + 1, threads_, [&](std::size_t task) {
      if (task == 0)
        digest.update(batch.bytes);
      else
        visitor_.at_once(piece_of(batch, task - 1));
    });
    if (visitor_.after) visitor_.after(batch.first + batch.count);
  }

  const ByteSource& source_;
  const Records records_;
  const RecordVisitor& visitor_;
  const int threads_;
  const std::uint64_t per_batch_, per_piece_;
  std::vector<std::byte> buffers_[2];
};

}  // namespace

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
