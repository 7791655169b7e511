#include "engine/volume/formats/grid_words.h"

#include <algorithm>

namespace geosis {
namespace {

// In the order of plausibility: revision 1's words, ensemble words, field words, and words of single systems.
std::vector<WordPair> usual_pairs(const ImportOptions& options) {
  const auto pair = [&](int inline_byte, int crossline_byte, WordPairKind kind) {
    return WordPair{{inline_byte, options.inline_width}, {crossline_byte, options.crossline_width}, kind};
  };
  return {pair(189, 193, WordPairKind::named),      pair(5, 21, WordPairKind::numbers),
          pair(9, 21, WordPairKind::numbers),       pair(9, 13, WordPairKind::record),
          pair(17, 21, WordPairKind::numbers),      pair(17, 25, WordPairKind::record),
          pair(221, 225, WordPairKind::numbers),    pair(233, 237, WordPairKind::numbers),
          pair(181, 185, WordPairKind::coordinates)};
}

Result<void> check_word(const char* name, std::optional<int> byte, int width) {
  if (width != 2 && width != 4)
    return Error{ErrorCode::invalid_argument,
                 std::string(name) + "_width " + std::to_string(width) + "; expected 2 or 4"};
  const int last = static_cast<int>(kTraceHeaderBytes) - width + 1;
  if (byte && (*byte < 1 || *byte > last))
    return Error{ErrorCode::invalid_argument, std::string(name) + "_byte " + std::to_string(*byte) + "; expected 1.." +
                                                  std::to_string(last) + " for " + std::to_string(width) + " bytes"};
  return {};
}

std::string trace_counts(const SegyLayout& layout) {
  return std::to_string(layout.traces) + " traces of " + std::to_string(layout.samples) + " samples";
}

Error not_3d(const std::string& why) {
  return {ErrorCode::unsupported, "SEG-Y: not a stacked 3D survey: " + why};
}

std::string offsets(const TraceScan& scan) {
  return describe("offsets", {37, 4}, scan.offset);
}

// One of the two numbers is the same everywhere.
Error line(const WordPair& pair, const TraceScan& scan) {
  const std::string kind = scan.offset.varies() ? "a prestack 2D line, " + offsets(scan) + ", " : "a 2D line, ";
  return not_3d(kind + describe("inline numbers", pair.inline_word, scan.range(pair.inline_word)) + ", " +
                describe("crossline numbers", pair.crossline_word, scan.range(pair.crossline_word)));
}

}  // namespace

Result<std::vector<WordPair>> pairs_to_try(const ImportOptions& options) {
  if (auto valid = check_word("inline", options.inline_byte, options.inline_width); !valid)
    return std::move(valid).error();
  if (auto valid = check_word("crossline", options.crossline_byte, options.crossline_width); !valid)
    return std::move(valid).error();
  const bool one_given = options.inline_byte || options.crossline_byte;
  std::vector<WordPair> pairs;
  for (WordPair pair : usual_pairs(options)) {
    if (options.inline_byte) pair.inline_word.byte = *options.inline_byte;
    if (options.crossline_byte) pair.crossline_word.byte = *options.crossline_byte;
    if (one_given) pair.kind = WordPairKind::named;
    const bool known = std::any_of(pairs.begin(), pairs.end(), [&](const WordPair& p) {
      return p.inline_word == pair.inline_word && p.crossline_word == pair.crossline_word;
    });
    if (!known && pair.inline_word.byte != pair.crossline_word.byte) pairs.push_back(pair);
  }
  if (pairs.empty())
    return Error{ErrorCode::invalid_argument,
                 "inline_byte and crossline_byte are both " + std::to_string(options.inline_byte.value_or(0))};
  return pairs;
}

std::string describe(const char* what, HeaderWord word, const WordRange& range) {
  std::string text = std::string(what) + " " + std::to_string(range.min());
  if (range.varies()) text += ".." + std::to_string(range.max()) + " step " + std::to_string(range.step());
  return text + " (byte " + std::to_string(word.byte) + (word.width == 2 ? ", 2 bytes wide)" : ")");
}

Error explain_named_pair(const WordPair& pair, const TraceScan& scan, const SegyLayout& layout,
                         std::int64_t duplicates) {
  const WordRange& inlines = scan.range(pair.inline_word);
  const WordRange& crosslines = scan.range(pair.crossline_word);
  if (!inlines.varies() || !crosslines.varies()) return line(pair, scan);
  const std::string numbers = describe("inline numbers", pair.inline_word, inlines) + ", " +
                              describe("crossline numbers", pair.crossline_word, crosslines);
  if (duplicates == 0)
    return {ErrorCode::limit_exceeded, "SEG-Y: " + trace_counts(layout) + " do not fill a grid of " +
                                           std::to_string(inlines.count()) + " x " +
                                           std::to_string(crosslines.count()) + ": " + numbers};
  const std::string shared =
      std::to_string(duplicates) + " of " + std::to_string(layout.traces) + " traces share the position of another: ";
  if (scan.offset.varies()) return not_3d("prestack, " + shared + offsets(scan) + ", " + numbers);
  return {ErrorCode::malformed_input,
          "SEG-Y: duplicate traces, " + shared + numbers + "; `duplicates` says which of them to take"};
}

Error explain_no_grid(const TraceScan& scan, const SegyLayout& layout) {
  if (layout.traces == 1) return not_3d("a single trace");
  const WordPair standard{kStandardInline, kStandardCrossline, WordPairKind::named};
  const bool inlines = scan.range(kStandardInline).varies(), crosslines = scan.range(kStandardCrossline).varies();
  if (inlines != crosslines) return line(standard, scan);

  const WordRange& records = scan.range(kFieldRecord);
  const WordRange& channels = scan.range(kTraceInRecord);
  if (!inlines && records.varies() && channels.varies())
    return not_3d("shot gathers, " + describe("field records", kFieldRecord, records) + ", " +
                  describe("trace numbers", kTraceInRecord, channels) +
                  (scan.offset.varies() ? ", " + offsets(scan) : ""));
  if (!inlines && scan.offset.varies()) return not_3d("prestack, " + offsets(scan));
  if (!inlines && scan.range(kEnsemble).varies())
    return not_3d("a 2D line, " + describe("ensembles", kEnsemble, scan.range(kEnsemble)));
  return {ErrorCode::malformed_input,
          "SEG-Y: the trace headers hold no survey grid: " + trace_counts(layout) + ", " +
              describe("inline numbers", kStandardInline, scan.range(kStandardInline)) + ", " +
              describe("crossline numbers", kStandardCrossline, scan.range(kStandardCrossline)) +
              "; inline_byte and crossline_byte name others"};
}

}  // namespace geosis
