// SPDX-License-Identifier: Apache-2.0
// Finds which elements of two sequences correspond.
#ifndef QUINTET_BASE_SEQUENCE_ALIGNMENT_H
#define QUINTET_BASE_SEQUENCE_ALIGNMENT_H

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace quintet {

// A pair of elements, or an element that only one sequence has: at least one of the indices is set.
struct AlignedPair {
  std::optional<std::size_t> a, b;
  bool operator==(const AlignedPair&) const = default;
};

inline constexpr unsigned kMostSimilar = 4;

// How similar element `a` of one sequence is to element `b` of the other: 0 to kMostSimilar; 0 means that they are no
// pair.
using Similarity = std::function<unsigned(std::size_t a, std::size_t b)>;

// Chooses the pairs, in the order of both sequences, whose similarities have the largest sum (Needleman and Wunsch
// 1970, "A General Method Applicable to the Search for Similarities in the Amino Acid Sequence of Two Proteins"). Of
// equal sums, it pairs elements early. Elements without a partner are between the pairs, those of `a` first.
//
// The work and the memory grow with the product of the lengths of the parts between the equal beginnings and ends.
// Above `maxCells` pairs, only elements near the diagonal are paired, so that the sum may be smaller.
std::vector<AlignedPair> alignSequences(std::size_t sizeA, std::size_t sizeB, const Similarity& similarity,
                                        std::size_t maxCells = std::size_t{1} << 22);

}  // namespace quintet
#endif
