#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace geosis {

/// Bytes of one text block of a SEG-Y file: 40 lines of 80 characters.
inline constexpr std::size_t kTextBytes = 3200;

/// A text block as UTF-8: EBCDIC or ASCII (found from its blanks), lines parted by '\n', trailing blanks and empty
/// lines at the end left out, control characters as blanks.
std::string decode_text_header(std::span<const std::byte> block);

/// Lines parted by '\n' as a text block in EBCDIC. errors: invalid_argument (more than 40 lines, a line of more than 80
/// characters, a character that is not printable ASCII).
Result<std::string> encode_text_header(std::string_view text);

}  // namespace geosis
