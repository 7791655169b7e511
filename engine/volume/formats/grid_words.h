#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/formats/trace_scan.h"

namespace geosis {

/// What a pair of header words usually holds, which decides how much it must prove to count as a survey grid.
enum class WordPairKind {
  named,        ///< inline and crossline by the standard (189 and 193) or by the caller
  numbers,      ///< words that processing systems use for inline and crossline
  record,       ///< field record and trace number: shot and channel in field data
  coordinates,  ///< CDP X and Y, in which some systems store the survey numbers
};

struct WordPair {
  HeaderWord inline_word, crossline_word;
  WordPairKind kind = WordPairKind::numbers;
};

inline constexpr HeaderWord kStandardInline{189, 4}, kStandardCrossline{193, 4};
inline constexpr HeaderWord kFieldRecord{9, 4}, kTraceInRecord{13, 4}, kEnsemble{21, 4};

/// The pairs to try, most plausible first; one alone when the options name both. errors: invalid_argument.
Result<std::vector<WordPair>> pairs_to_try(const ImportOptions& options);

/// Bytes and range, for messages: "inline numbers 1..5 step 1 (byte 189)".
std::string describe(const char* what, HeaderWord word, const WordRange& range);

/// Why the traces make no grid by themselves, for people: 2D line, prestack, shot gathers, or simply none.
/// scan has the ranges of the standard, record and ensemble words.
Error explain_no_grid(const TraceScan& scan, const SegyLayout& layout);

/// Why the pair that the caller (or the standard) named makes no grid. errors as for find_grid.
Error explain_named_pair(const WordPair& pair, const TraceScan& scan, const SegyLayout& layout,
                         std::int64_t duplicates);

}  // namespace geosis
