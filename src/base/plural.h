// SPDX-License-Identifier: Apache-2.0
// Numbers with a noun in messages.
#ifndef QUINTET_BASE_PLURAL_H
#define QUINTET_BASE_PLURAL_H

#include <string>
#include <string_view>

namespace quintet {

// Returns "sample" for 1 and "samples" for other numbers. `plural`: of irregular nouns.
template <class Number>
std::string nounFor(Number number, std::string_view noun, std::string_view plural = {}) {
  if (number == 1) return std::string(noun);
  return plural.empty() ? std::string(noun) + "s" : std::string(plural);
}

// Returns "1 sample", "2 samples".
template <class Integer>
std::string counted(Integer number, std::string_view noun, std::string_view plural = {}) {
  return std::to_string(number) + " " + nounFor(number, noun, plural);
}

}  // namespace quintet
#endif
