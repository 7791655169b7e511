#include "engine/volume/formats/trace_mover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr std::int16_t kDeadTrace = 2;  // trace identification code, byte 29
constexpr std::int64_t kPositionsBetweenChecks = 1024;

/// Mean of several traces, sample by sample, over those that have one; summed in the order of add().
class TraceMean {
 public:
  explicit TraceMean(std::size_t samples) : sums_(samples), counts_(samples) {}

  void add(std::span<const float> samples) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (std::isnan(samples[k])) continue;
      sums_[k] += samples[k];
      ++counts_[k];
    }
  }
  void store(std::span<float> samples) const {
    for (std::size_t k = 0; k < samples.size(); ++k)
      samples[k] = counts_[k] > 0 ? static_cast<float>(sums_[k] / static_cast<double>(counts_[k])) : kMissing;
  }

 private:
  std::vector<double> sums_;
  std::vector<std::int64_t> counts_;
};

}  // namespace

TraceMover::TraceMover(const ByteSource& source, const SegyLayout& layout, const TraceGrid& grid,
                       const ImportOptions& options, std::vector<CoordinateWords>& coordinates, BrickWriter& writer)
    : source_(source),
      layout_(layout),
      grid_(grid),
      options_(options),
      null_(options.null_value, layout.code),
      coordinates_(coordinates),
      writer_(writer) {}

Result<std::string> TraceMover::move_all(int threads, Progress& progress) {
  const Records records{layout_.first_trace, layout_.trace_bytes(), layout_.traces};
  RecordVisitor visitor;
  visitor.in_order = [this](const RecordBatch& batch) { read_headers(batch); };
  visitor.in_parts = [&](const RecordBatch& batch, std::size_t part) {
    move_batch(share_of(batch, part, visitor.parts));
    return Result<void>();
  };
  auto digest = stream_records(source_, records, visitor, threads, progress);
  if (!digest) return digest;
  if (changed_) return Error{ErrorCode::unavailable, "SEG-Y: the file changed while it was read"};
  if (auto moved = move_shared(progress); !moved) return std::move(moved).error();
  if (!fill_absent(progress)) return Error{ErrorCode::cancelled, "cancelled"};
  return digest;
}

std::vector<Warning> TraceMover::warnings() const {
  std::vector<Warning> warnings;
  if (dead_ > 0)
    warnings.push_back(
        {"dead_traces", std::to_string(dead_) + " traces are marked dead (2 at byte 29): taken as missing"});
  if (grid_.map.duplicates() > 0)
    warnings.push_back(
        {"duplicate_traces", std::to_string(grid_.map.duplicates()) + " traces share the position of another"});
  return warnings;
}

// -1 when the header no longer says what it said when the grid was found.
std::int64_t TraceMover::position_of(const HeaderView& header) const {
  const std::int64_t position = grid_.position_in(header);
  const bool known = position >= 0 && position < grid_.map.positions() && grid_.map.occupied(position);
  return known ? position : -1;
}

void TraceMover::read_headers(const RecordBatch& batch) {
  for (std::uint64_t t = 0; t < batch.count; ++t) {
    const HeaderView header = header_of(batch.bytes.subspan(t * layout_.trace_bytes(), kTraceHeaderBytes));
    const std::int64_t position = position_of(header);
    if (position < 0) {
      changed_ = true;
      continue;
    }
    for (CoordinateWords& words : coordinates_) words.add(header, grid_, position);
    if (grid_.map.shared(position)) shared_.push_back({position, batch.first + t});
  }
}

void TraceMover::move_batch(const RecordBatch& batch) {
  std::vector<float> samples(static_cast<std::size_t>(layout_.samples));
  for (std::uint64_t t = 0; t < batch.count; ++t) {
    const auto trace = batch.bytes.subspan(t * layout_.trace_bytes(), layout_.trace_bytes());
    const std::int64_t position = position_of(header_of(trace));
    if (position < 0 || grid_.map.shared(position)) continue;
    decode(trace, samples);
    put(position, samples);
  }
}

// The samples of one trace; all missing when it is dead, or empty and `zero_traces` says so.
void TraceMover::decode(std::span<const std::byte> trace, std::span<float> samples) {
  decode_samples(layout_.code, layout_.big_endian, trace.subspan(layout_.header_bytes), samples);
  const SampleCounts counts = null_.clean(samples);
  tally_.add_infinite(counts.infinite);
  const bool dead = header_of(trace).at<std::int16_t>(29) == kDeadTrace;
  const bool empty = counts.all_zero && options_.zero_traces == ZeroTraces::missing;
  dead_ += dead;
  if (dead || empty) std::fill(samples.begin(), samples.end(), kMissing);
}

void TraceMover::put(std::int64_t position, std::span<const float> samples) {
  std::int64_t missing = 0;
  for (const float value : samples) missing += value != value;
  tally_.add_trace(layout_.samples, missing);
  writer_.put(static_cast<std::int32_t>(position / grid_.crosslines.count),
              static_cast<std::int32_t>(position % grid_.crosslines.count), 0, samples);
}

Result<void> TraceMover::move_shared(Progress& progress) {
  std::sort(shared_.begin(), shared_.end());
  for (auto first = shared_.begin(); first != shared_.end();) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
    const auto last =
        std::find_if(first, shared_.end(), [&](const SharedTrace& s) { return s.position != first->position; });
    if (auto moved = move_group({first, last}); !moved) return moved;
    first = last;
  }
  return {};
}

// Traces of one position, in file order.
Result<void> TraceMover::move_group(std::span<const SharedTrace> group) {
  if (options_.duplicates == DuplicateTraces::first) group = group.first(1);
  if (options_.duplicates == DuplicateTraces::last) group = group.last(1);
  std::vector<std::byte> trace(layout_.trace_bytes());
  std::vector<float> samples(static_cast<std::size_t>(layout_.samples));
  TraceMean mean(samples.size());
  for (const SharedTrace& shared : group) {
    const std::uint64_t offset = layout_.first_trace + shared.trace * layout_.trace_bytes();
    if (auto read = source_.read_at(offset, trace); !read) return read;
    decode(trace, samples);
    mean.add(samples);
  }
  if (group.size() > 1) mean.store(samples);
  put(group.front().position, samples);
  return {};
}

// False when cancelled.
bool TraceMover::fill_absent(Progress& progress) {
  const std::vector<float> missing(static_cast<std::size_t>(layout_.samples), kMissing);
  for (std::int64_t position = 0; position < grid_.map.positions(); ++position) {
    if (position % kPositionsBetweenChecks == 0 && progress.cancelled()) return false;
    if (!grid_.map.occupied(position)) put(position, missing);
  }
  return true;
}

}  // namespace geosis
