// SPDX-License-Identifier: Apache-2.0
// Text for one line of a terminal or a log: safe text from files and devices, sizes and durations.
#ifndef QUINTET_BASE_TEXT_H
#define QUINTET_BASE_TEXT_H

#include <cstdint>
#include <string>
#include <string_view>

namespace quintet {

// Returns `text` with '?' for control characters and for bytes that are not valid UTF-8.
std::string printable(std::string_view text);

// Returns the text with the letters A to Z in lower case.
std::string lowerCase(std::string_view text);

// Returns the text without spaces, tabs and line ends at both ends.
std::string_view trimmed(std::string_view text);

// Returns the text, in single quotes where a shell would need them.
std::string shellQuoted(std::string_view text);

// Returns "812 bytes" or "3.2 MiB".
std::string bytesText(std::uint64_t bytes);

// Returns "2.5 s", "75 s", "2:05" or "1:02:05"; "?" from 10⁹ seconds on and for NaN. Negative durations count as 0.
std::string durationText(double seconds);

}  // namespace quintet
#endif
