// SPDX-License-Identifier: Apache-2.0
#include "viewer/labels.h"

#include <cstddef>

namespace quintet::viewer {

std::string groupedDigits(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

std::string capitalized(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

}  // namespace quintet::viewer
