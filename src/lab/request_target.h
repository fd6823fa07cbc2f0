// SPDX-License-Identifier: Apache-2.0
// The target of a request: path and query, decoded. What is not plain percent-encoding is rejected.
#ifndef QUINTET_LAB_REQUEST_TARGET_H
#define QUINTET_LAB_REQUEST_TARGET_H

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace quintet::lab {

// "a%20b" → "a b"; nothing for incomplete or wrong escapes, and for encoded zero bytes.
std::optional<std::string> decodePercent(std::string_view text);

struct RequestTarget {
  std::string path;                          // "/api/files/a b"
  std::map<std::string, std::string> query;  // of repeated names the last value
};

// Returns nothing for a target that does not begin with '/', for incomplete or wrong escapes, and for encoded zero bytes.
std::optional<RequestTarget> parseTarget(std::string_view target);

}  // namespace quintet::lab
#endif
