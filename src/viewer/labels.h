// SPDX-License-Identifier: Apache-2.0
// Texts of the interface.
#ifndef QUINTET_VIEWER_LABELS_H
#define QUINTET_VIEWER_LABELS_H

#include <cstdint>
#include <string>

namespace quintet::viewer {

std::string groupedDigits(std::uint64_t number);  // "1,234,567"
std::string capitalized(std::string text);        // the first letter in upper case, if it is one of a to z

}  // namespace quintet::viewer
#endif
