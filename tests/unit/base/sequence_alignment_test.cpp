// SPDX-License-Identifier: Apache-2.0
// Alignments against the largest sum of all alignments.
#include "base/sequence_alignment.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace quintet {
namespace {

// Equal letters are equal elements, the two cases of a letter are similar, and letters and digits are no pairs.
unsigned similar(char a, char b) {
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  if (a == b) return kMostSimilar;
  if ((a | 0x20) == (b | 0x20)) return 2;
  return isDigit(a) == isDigit(b) ? 1 : 0;
}

std::vector<AlignedPair> align(const std::string& a, const std::string& b, std::size_t maxCells = 1 << 20) {
  return alignSequences(
      a.size(), b.size(), [&](std::size_t i, std::size_t j) { return similar(a[i], b[j]); }, maxCells);
}

// The elements of both, "-" for none: "ab-d", "a-cd".
std::pair<std::string, std::string> textOf(const std::string& a, const std::string& b,
                                           const std::vector<AlignedPair>& pairs) {
  std::pair<std::string, std::string> text;
  for (const AlignedPair& pair : pairs) {
    text.first += pair.a ? a.at(*pair.a) : '-';
    text.second += pair.b ? b.at(*pair.b) : '-';
  }
  return text;
}

std::pair<std::string, std::string> aligned(const std::string& a, const std::string& b) {
  return textOf(a, b, align(a, b));
}

unsigned sumOf(const std::string& a, const std::string& b, const std::vector<AlignedPair>& pairs) {
  unsigned sum = 0;
  for (const AlignedPair& pair : pairs)
    if (pair.a && pair.b) sum += similar(a[*pair.a], b[*pair.b]);
  return sum;
}

// The largest sum, by trying all alignments.
unsigned largestSum(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return 0;
  const std::string restA = a.substr(1), restB = b.substr(1);
  return std::max({similar(a[0], b[0]) + largestSum(restA, restB), largestSum(restA, b), largestSum(a, restB)});
}

void expectComplete(const std::string& a, const std::string& b, const std::vector<AlignedPair>& pairs) {
  std::string restA, restB;
  for (const AlignedPair& pair : pairs) {
    EXPECT_TRUE(pair.a || pair.b);
    EXPECT_TRUE(!pair.a || !pair.b || similar(a.at(*pair.a), b.at(*pair.b)) > 0) << a << " " << b;
    if (pair.a) restA += a.at(*pair.a);
    if (pair.b) restB += b.at(*pair.b);
  }
  EXPECT_EQ(restA, a);
  EXPECT_EQ(restB, b);
}

TEST(SequenceAlignment, KeepsEqualElementsTogether) {
  using Pair = std::pair<std::string, std::string>;
  EXPECT_EQ(aligned("", ""), Pair("", ""));
  EXPECT_EQ(aligned("abc", ""), Pair("abc", "---"));
  EXPECT_EQ(aligned("abc", "abc"), Pair("abc", "abc"));
  EXPECT_EQ(aligned("ac", "abc"), Pair("a-c", "abc"));
  EXPECT_EQ(aligned("abcd", "abCd"), Pair("abcd", "abCd"));
  EXPECT_EQ(aligned("ab12c", "ac"), Pair("ab12c", "a---c"));
  EXPECT_EQ(aligned("a1b", "azb"), Pair("a1-b", "a-zb")) << "the element of the first sequence is first";
  EXPECT_EQ(aligned("abb", "acB"), Pair("abb", "acB"));
}

TEST(SequenceAlignment, HasTheLargestSum) {
  std::mt19937 random(1);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const auto text = [&] {
      std::string result(random() % 7, ' ');
      for (char& c : result) c = "abABx1"[random() % 6];
      return result;
    };
    const std::string a = text(), b = text();
    const std::vector<AlignedPair> pairs = align(a, b);
    expectComplete(a, b, pairs);
    EXPECT_EQ(sumOf(a, b, pairs), largestSum(a, b)) << a << " " << b;
  }
}

TEST(SequenceAlignment, LongSequencesStayCompleteAndFindInsertions) {
  std::mt19937 random(2);
  for (const std::size_t size : {std::size_t{1}, std::size_t{40}, std::size_t{500}}) {
    std::string a(500, ' ');
    for (char& c : a) c = "abcdefgh1234"[random() % 12];
    std::string b = a.substr(0, size);
    b.insert(b.begin() + static_cast<std::ptrdiff_t>(size / 2), 'X');
    b.front() = 'Y';
    b.back() = 'Z';
    const std::vector<AlignedPair> pairs = align(a, b, 8000);  // less than a tenth of all pairs
    expectComplete(a, b, pairs);
    if (size == 500) {
      EXPECT_GE(sumOf(a, b, pairs), 498 * kMostSimilar);
    }
  }
}

}  // namespace
}  // namespace quintet
