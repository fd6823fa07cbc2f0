// SPDX-License-Identifier: Apache-2.0
#include "target.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace quintet::fuzz {

void reportFinding(std::string_view text) {
  std::fprintf(stderr, "finding: %.*s\n", static_cast<int>(text.size()), text.data());
  std::abort();
}

void checkMessage(std::string_view message) {
  if (message.empty()) reportFinding("an error has no message");
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      reportFinding("an error message has a control character: " + std::string(message));
}

}  // namespace quintet::fuzz

// libFuzzer calls this for each input.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  quintet::fuzz::readInput({reinterpret_cast<const std::byte*>(data), size});
  return 0;
}
