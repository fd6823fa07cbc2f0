// SPDX-License-Identifier: Apache-2.0
// What the libFuzzer targets share. A target reads one input of any bytes. It may throw an Error whose text is one line
// (error.h); any other exception, a crash, a leak, a large allocation and a missed property are findings.
#ifndef QUINTET_TESTS_FUZZ_TARGET_H
#define QUINTET_TESTS_FUZZ_TARGET_H

#include <cstddef>
#include <span>
#include <string_view>

#include "base/error.h"

namespace quintet::fuzz {

using Input = std::span<const std::byte>;

// Memory that a file can request, in bytes. tests/fuzz/targets/run makes larger single allocations a finding.
inline constexpr std::size_t kMaxMemory = std::size_t{64} << 20;

// The entry point of a target; each target defines it in a file of its own.
void readInput(Input input);

inline std::string_view textOf(Input input) { return {reinterpret_cast<const char*>(input.data()), input.size()}; }

// Prints the text and aborts, which libFuzzer reports with the input.
[[noreturn]] void reportFinding(std::string_view text);

// Reports a message that is empty or has control characters.
void checkMessage(std::string_view message);

// Calls read(), which may throw an Error. Returns whether it returned.
template <class Read>
bool acceptErrors(const Read& read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    checkMessage(error.what());
    return false;
  }
}

}  // namespace quintet::fuzz
#endif
