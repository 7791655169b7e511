#include "engine/volume/formats/trace_grid.h"

#include <algorithm>
#include <utility>

#include "engine/volume/brick_layout.h"
#include "engine/volume/formats/grid_words.h"

namespace geosis {
namespace {

/// Positions per trace up to which a pair of words counts as a grid: found by itself, and named by the caller. Beyond
/// that headers are nonsense, and the brick file would be mostly missing samples.
constexpr std::int64_t kSparsestFound = 8, kSparsestNamed = 64;

struct Proposal {
  WordPair pair;
  TraceGrid grid;
  std::vector<bool> same_as;  // for each earlier proposal: every trace lies at the same place
};

std::vector<HeaderWord> words_of(const std::vector<WordPair>& pairs) {
  std::vector<HeaderWord> words = {kStandardInline, kStandardCrossline, kFieldRecord, kTraceInRecord, kEnsemble};
  for (const WordPair& pair : pairs)
    for (const HeaderWord word : {pair.inline_word, pair.crossline_word})
      if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  return words;
}

bool fits_axes(const WordPair& pair, const TraceScan& scan) {
  const WordRange& inlines = scan.range(pair.inline_word);
  const WordRange& crosslines = scan.range(pair.crossline_word);
  return inlines.varies() && crosslines.varies() && inlines.count() <= kMaxAxisNodes &&
         crosslines.count() <= kMaxAxisNodes;
}

// Whether the numbers alone leave the pair a chance to be a grid of this many traces.
bool is_plausible(const WordPair& pair, const TraceScan& scan, std::int64_t traces, bool both_given) {
  if (!fits_axes(pair, scan)) return false;
  const std::int64_t inlines = scan.range(pair.inline_word).count();
  const std::int64_t crosslines = scan.range(pair.crossline_word).count();
  const std::int64_t positions = inlines * crosslines;
  if (both_given) return positions / kSparsestNamed <= traces;
  // The points of a crooked line also have two numbers each, but no more points than numbers.
  if (positions / kSparsestFound > traces || traces < inlines + crosslines) return false;
  if (pair.kind == WordPairKind::named) return true;
  if (positions < traces || scan.offset.varies()) return false;
  return pair.kind != WordPairKind::record || positions * 3 <= traces * 4;
}

GridNumbers numbers(HeaderWord word, const WordRange& range) {
  return {word, range.min(), range.step(), static_cast<std::int32_t>(range.count())};
}

std::vector<Proposal> propose(const std::vector<WordPair>& pairs, const TraceScan& scan, std::int64_t traces,
                              bool both_given) {
  std::vector<Proposal> proposals;
  for (const WordPair& pair : pairs) {
    if (!is_plausible(pair, scan, traces, both_given)) continue;
    Proposal proposal;
    proposal.pair = pair;
    proposal.grid.inlines = numbers(pair.inline_word, scan.range(pair.inline_word));
    proposal.grid.crosslines = numbers(pair.crossline_word, scan.range(pair.crossline_word));
    proposal.grid.map = TraceMap(std::int64_t{proposal.grid.inlines.count} * proposal.grid.crosslines.count);
    for (const Proposal& earlier : proposals)
      proposal.same_as.push_back(earlier.grid.inlines.count == proposal.grid.inlines.count &&
                                 earlier.grid.crosslines.count == proposal.grid.crosslines.count);
    proposals.push_back(std::move(proposal));
  }
  return proposals;
}

// The second pass: puts every trace into every proposed grid. An error when a header says something else than in the
// first pass, as it does in a file that is being written.
Result<void> place_traces(const ByteSource& source, const SegyLayout& layout, Progress& progress,
                          std::vector<Proposal>& proposals) {
  std::vector<std::int64_t> positions(proposals.size());
  bool changed = false;
  auto visited = for_each_trace_header(source, layout, progress, [&](const HeaderView& header) {
    for (std::size_t p = 0; p < proposals.size(); ++p) {
      Proposal& proposal = proposals[p];
      positions[p] = proposal.grid.position_in(header);
      if (positions[p] < 0 || positions[p] >= proposal.grid.map.positions()) {
        changed = true;
        return;
      }
      proposal.grid.map.add(positions[p]);
      for (std::size_t q = 0; q < p; ++q)
        if (positions[q] != positions[p]) proposal.same_as[q] = false;
    }
  });
  if (visited && changed) return Error{ErrorCode::unavailable, "SEG-Y: the file changed while it was read"};
  return visited;
}

bool repeats_an_earlier(const Proposal& proposal) {
  return std::find(proposal.same_as.begin(), proposal.same_as.end(), true) != proposal.same_as.end();
}

// The proposals that remain rivals once all traces are placed.
std::vector<Proposal> rivals_among(std::vector<Proposal> proposals, DuplicateTraces duplicates) {
  std::erase_if(proposals, [&](const Proposal& p) {
    const bool may_share = duplicates != DuplicateTraces::reject && p.pair.kind == WordPairKind::named;
    return repeats_an_earlier(p) || (p.grid.map.duplicates() > 0 && !may_share);
  });
  // Coordinates lie on a lattice too: they count only where no survey numbers do.
  const bool has_numbers = std::any_of(proposals.begin(), proposals.end(),
                                       [](const Proposal& p) { return p.pair.kind != WordPairKind::coordinates; });
  if (has_numbers) std::erase_if(proposals, [](const Proposal& p) { return p.pair.kind == WordPairKind::coordinates; });
  std::int64_t fewest = proposals.empty() ? 0 : proposals.front().grid.map.positions();
  for (const Proposal& p : proposals) fewest = std::min(fewest, p.grid.map.positions());
  std::erase_if(proposals, [&](const Proposal& p) { return p.grid.map.positions() >= 2 * fewest; });
  return proposals;
}

GridCandidate candidate(const Proposal& proposal, std::int32_t samples) {
  const TraceGrid& grid = proposal.grid;
  return {grid.inlines.word.byte,
          grid.crosslines.word.byte,
          {grid.inlines.count, grid.crosslines.count, samples},
          grid.map.positions() - grid.map.live()};
}

Error ambiguous(const std::vector<Proposal>& rivals) {
  std::string text = "SEG-Y: several pairs of header bytes make a grid:";
  for (const Proposal& p : rivals)
    text += (&p == &rivals.front() ? " " : ", ") + std::to_string(p.grid.inlines.word.byte) + "/" +
            std::to_string(p.grid.crosslines.word.byte) + " (" + std::to_string(p.grid.inlines.count) + " x " +
            std::to_string(p.grid.crosslines.count) + ", " +
            std::to_string(p.grid.map.positions() - p.grid.map.live()) + " missing)";
  return {ErrorCode::malformed_input, text + "; name one by inline_byte and crossline_byte"};
}

// Duplicates under the standard's own words say more than that no other pair fits either.
Error explain(const std::vector<WordPair>& pairs, const std::vector<Proposal>& proposals, const TraceScan& scan,
              const SegyLayout& layout, bool both_given) {
  for (const Proposal& p : proposals)
    if (p.pair.kind == WordPairKind::named && p.grid.map.duplicates() > 0)
      return explain_named_pair(p.pair, scan, layout, p.grid.map.duplicates());
  if (both_given) return explain_named_pair(pairs.front(), scan, layout, 0);
  return explain_no_grid(scan, layout);
}

}  // namespace

void TraceMap::add(std::int64_t position) {
  const auto p = static_cast<std::size_t>(position);
  if (!occupied_[p]) {
    occupied_[p] = true;
    ++live_;
    return;
  }
  ++duplicates_;
  if (shared_.empty()) shared_.resize(occupied_.size());
  shared_[p] = true;
}

Result<FoundGrid> find_grid(const ByteSource& source, const SegyLayout& layout, const ImportOptions& options,
                            Progress& progress, std::vector<GridCandidate>* candidates) {
  const auto pairs = pairs_to_try(options);
  if (!pairs) return pairs.error();
  auto scan = scan_traces(source, layout, words_of(*pairs), progress);
  if (!scan) return std::move(scan).error();

  const bool both_given = options.inline_byte && options.crossline_byte;
  std::vector<Proposal> proposals = propose(*pairs, *scan, static_cast<std::int64_t>(layout.traces), both_given);
  if (!proposals.empty())
    if (auto placed = place_traces(source, layout, progress, proposals); !placed) return std::move(placed).error();
  std::vector<Proposal> rivals = rivals_among(proposals, options.duplicates);
  if (rivals.size() == 1) return FoundGrid{std::move(rivals.front().grid), *std::move(scan)};
  if (candidates)
    for (const Proposal& p : rivals) candidates->push_back(candidate(p, layout.samples));
  if (!rivals.empty()) return ambiguous(rivals);
  return explain(*pairs, proposals, *scan, layout, both_given);
}

}  // namespace geosis
