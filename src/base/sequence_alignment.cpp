// SPDX-License-Identifier: Apache-2.0
#include "base/sequence_alignment.h"

#include <algorithm>
#include <cstdint>

namespace quintet {
namespace {

// The largest sums of similarities of all pairs of ends of the two sequences. Row i has the columns from first(i) to
// end(i), which are all of them if the table is small.
class SumTable {
 public:
  SumTable(std::size_t sizeA, std::size_t sizeB, std::size_t maxCells) : sizeA_(sizeA), sizeB_(sizeB) {
    const std::size_t rows = sizeA + 1, columns = sizeB + 1;
    // Half of the width. Neighboring rows must share a column.
    halfWidth_ = rows * columns <= maxCells ? columns : std::max(maxCells / (2 * rows), columns / rows + 1);
    offsets_.reserve(rows + 1);
    offsets_.push_back(0);
    for (std::size_t i = 0; i < rows; ++i) offsets_.push_back(offsets_.back() + end(i) - first(i));
    sums_.resize(offsets_.back());
  }
  std::size_t first(std::size_t i) const {
    const std::size_t middle = middleOf(i);
    return middle > halfWidth_ ? middle - halfWidth_ : 0;
  }
  std::size_t end(std::size_t i) const { return std::min(middleOf(i) + halfWidth_, sizeB_) + 1; }
  bool has(std::size_t i, std::size_t j) const { return i <= sizeA_ && j >= first(i) && j < end(i); }
  // Of the elements from i and from j on.
  std::uint32_t& at(std::size_t i, std::size_t j) { return sums_[offsets_[i] + j - first(i)]; }

 private:
  std::size_t middleOf(std::size_t i) const { return sizeA_ > 0 ? i * sizeB_ / sizeA_ : 0; }

  std::size_t sizeA_, sizeB_, halfWidth_;
  std::vector<std::size_t> offsets_;  // of the rows in sums_
  std::vector<std::uint32_t> sums_;
};

// Appends the pairs of the elements from `begin` on; `sizeA` and `sizeB` elements are left.
void alignMiddle(std::vector<AlignedPair>& result, std::size_t begin, std::size_t sizeA, std::size_t sizeB,
                 const Similarity& similarity, std::size_t maxCells) {
  SumTable sums(sizeA, sizeB, maxCells);
  for (std::size_t i = sizeA + 1; i-- > 0;)
    for (std::size_t j = sums.end(i); j-- > sums.first(i);) {
      std::uint32_t best = 0;
      if (sums.has(i + 1, j)) best = std::max(best, sums.at(i + 1, j));
      if (j < sizeB && sums.has(i, j + 1)) best = std::max(best, sums.at(i, j + 1));
      if (j < sizeB && sums.has(i + 1, j + 1))
        if (const unsigned similar = similarity(begin + i, begin + j); similar > 0)
          best = std::max(best, sums.at(i + 1, j + 1) + similar);
      sums.at(i, j) = best;
    }
  for (std::size_t i = 0, j = 0; i < sizeA || j < sizeB;) {
    const std::uint32_t sum = sums.at(i, j);
    const bool both = i < sizeA && j < sizeB && sums.has(i + 1, j + 1);
    const unsigned similar = both ? similarity(begin + i, begin + j) : 0;
    if (similar > 0 && sums.at(i + 1, j + 1) + similar == sum) {
      result.push_back({begin + i++, begin + j++});
    } else if (sums.has(i + 1, j) && sums.at(i + 1, j) == sum) {
      result.push_back({begin + i++, std::nullopt});
    } else {
      result.push_back({std::nullopt, begin + j++});
    }
  }
}

}  // namespace

std::vector<AlignedPair> alignSequences(std::size_t sizeA, std::size_t sizeB, const Similarity& similarity,
                                        std::size_t maxCells) {
  std::vector<AlignedPair> result;
  const std::size_t shorter = std::min(sizeA, sizeB);
  std::size_t begin = 0, tail = 0;
  for (; begin < shorter && similarity(begin, begin) == kMostSimilar; ++begin) result.push_back({begin, begin});
  while (tail < shorter - begin && similarity(sizeA - tail - 1, sizeB - tail - 1) == kMostSimilar) ++tail;
  alignMiddle(result, begin, sizeA - begin - tail, sizeB - begin - tail, similarity, maxCells);
  for (; tail > 0; --tail) result.push_back({sizeA - tail, sizeB - tail});
  return result;
}

}  // namespace quintet
