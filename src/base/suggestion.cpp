// SPDX-License-Identifier: Apache-2.0
#include "base/suggestion.h"

#include <fmt/format.h>

#include <algorithm>

namespace quintet {
namespace {

// The cost of an edit distance grows with the product of the lengths.
constexpr std::size_t kMaxNameBytes = 64;

std::size_t levenshteinDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j < row.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string nearestName(std::string_view name, const std::vector<std::string>& candidates) {
  if (name.size() > kMaxNameBytes) return {};
  std::string best;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 2);
  for (const std::string& candidate : candidates) {
    const std::size_t distance = levenshteinDistance(name, candidate);
    if (distance < bestDistance || (distance == bestDistance && best.empty())) {
      best = candidate;
      bestDistance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearestName(name, candidates);
  return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

std::string suggestionOrList(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string hint = suggestion(name, candidates);
  return hint.empty() ? fmt::format("; available: {}", fmt::join(candidates, ", ")) : hint;
}

}  // namespace quintet
