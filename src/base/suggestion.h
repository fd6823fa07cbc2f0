// SPDX-License-Identifier: Apache-2.0
// Hints for names that do not exist: the nearest known name.
#ifndef QUINTET_BASE_SUGGESTION_H
#define QUINTET_BASE_SUGGESTION_H

#include <string>
#include <string_view>
#include <vector>

namespace quintet {

// Returns the candidate with the smallest edit distance to `name`; empty if none is near (at most 2 edits, or half the
// length of a longer name) or if the name has more than 64 bytes.
std::string nearestName(std::string_view name, const std::vector<std::string>& candidates);

// Returns " (did you mean 'size'?)"; empty if no candidate is near.
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

// Returns " (did you mean 'size'?)" if a candidate is near, "; available: a, b, c" otherwise.
std::string suggestionOrList(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace quintet
#endif
