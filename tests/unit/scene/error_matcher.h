// SPDX-License-Identifier: Apache-2.0
// Matches messages by location and essential words, so that tests do not depend on whole sentences.
#ifndef QUINTET_TESTS_ERROR_MATCHER_H
#define QUINTET_TESTS_ERROR_MATCHER_H

#include <gmock/gmock.h>

#include <string>

namespace quintet::test {

// "location: problem", or "problem" if the location is empty, where the problem contains `words`.
MATCHER_P2(IsErrorAt, location, words, "") {
  const std::string message = arg,
                    prefix = std::string(location).empty() ? std::string() : location + std::string(": ");
  return message.starts_with(prefix) && message.find(words, prefix.size()) != std::string::npos;
}

}  // namespace quintet::test
#endif
