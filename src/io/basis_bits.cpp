// SPDX-License-Identifier: Apache-2.0
#include "io/basis_bits.h"

#include <algorithm>

namespace quintet::io {
namespace {

// Order of the lengths of the code for lengths.
constexpr std::array<std::uint8_t, 21> kLengthOrder{17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                    11, 4,  12, 3,  13, 2, 14, 1, 15, 16};

// A symbol above 16 repeats a length: 0 or the previous one.
struct Repeat {
  std::uint32_t bits, least;
  bool previous;
};
constexpr std::uint32_t kFirstRepeat = 17;
constexpr std::array<Repeat, 4> kRepeats{{{3, 3, false}, {7, 11, false}, {2, 3, true}, {7, 7, true}}};

// Lengths of the code for lengths.
std::vector<std::uint8_t> readOuterLengths(BasisBits& bits) {
  const std::uint32_t count = bits.read(5);
  if (count == 0 || count > kLengthOrder.size()) bits.fail("the Huffman table of BasisLZ is not valid");
  std::vector<std::uint8_t> lengths(kLengthOrder.size());
  for (std::uint32_t i = 0; i < count; ++i) lengths[kLengthOrder[i]] = static_cast<std::uint8_t>(bits.read(3));
  return lengths;
}

}  // namespace

void BasisBits::refill() {
  for (; available_ <= 56 && next_ < end_; available_ += 8)
    bits_ |= std::uint64_t{(*source_)[static_cast<std::size_t>(next_++)]} << available_;
}

std::uint32_t BasisBits::readGroups(std::uint32_t count) {
  std::uint32_t value = 0;
  for (std::uint32_t shift = 0; shift < 32; shift += count) {
    const std::uint32_t group = read(count + 1);
    value |= (group & ((1u << count) - 1)) << shift;
    if (group >> count == 0) return value;
  }
  fail("a number of BasisLZ is too long");
}

void BasisBits::fail(const std::string& problem) const {
  source_->fail(static_cast<std::size_t>(next_ - available_ / 8), problem);
}

BasisCode::BasisCode(const BasisBits& bits, const std::vector<std::uint8_t>& lengths) : short_(1u << kShortBits) {
  for (const std::uint8_t length : lengths) ++count_[length];
  const auto used = static_cast<std::uint32_t>(lengths.size()) - count_[0];
  count_[0] = 0;
  std::array<std::uint32_t, kMaxBits + 1> next{}, position{};  // code and position in symbols_
  std::uint32_t code = 0, before = 0;
  for (std::uint32_t length = 1; length <= kMaxBits; ++length) {
    code <<= 1;
    first_[length] = next[length] = code;
    position[length] = before;
    code += count_[length], before += count_[length];
    if (code > 1u << length) bits.fail("the Huffman table of BasisLZ is not valid");
  }
  // All codes must be used, unless there is one symbol.
  if (used > 1 && code != 1u << kMaxBits) bits.fail("the Huffman table of BasisLZ is not valid");

  symbols_.resize(used);
  for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
    const std::uint32_t length = lengths[symbol];
    if (length == 0) continue;
    symbols_[position[length]++] = static_cast<std::uint16_t>(symbol);
    const std::uint32_t own = next[length]++;
    if (length > kShortBits) continue;
    std::uint32_t reversed = 0;  // the first bit of a code is its highest one
    for (std::uint32_t i = 0; i < length; ++i) reversed |= (own >> i & 1) << (length - 1 - i);
    for (std::uint32_t i = reversed; i < short_.size(); i += 1u << length)
      short_[i] = {static_cast<std::uint16_t>(symbol), static_cast<std::uint8_t>(length)};
  }
}

BasisCode::BasisCode(BasisBits& bits) {
  const std::uint32_t count = bits.read(14);
  if (count == 0) {
    short_.resize(1u << kShortBits);
    return;
  }
  const BasisCode lengthCode(bits, readOuterLengths(bits));
  std::vector<std::uint8_t> lengths;
  lengths.reserve(count);
  while (lengths.size() < count) {
    const std::uint32_t symbol = lengthCode(bits);
    if (symbol < kFirstRepeat) {
      lengths.push_back(static_cast<std::uint8_t>(symbol));
      continue;
    }
    const Repeat& repeat = kRepeats[symbol - kFirstRepeat];
    const std::uint32_t times = repeat.least + bits.read(repeat.bits);
    const std::uint8_t length = repeat.previous && !lengths.empty() ? lengths.back() : std::uint8_t{0};
    if (times > count - lengths.size() || (repeat.previous && length == 0))
      bits.fail("the Huffman table of BasisLZ is not valid");
    lengths.insert(lengths.end(), times, length);
  }
  *this = BasisCode(bits, lengths);
}

std::uint32_t BasisCode::readLong(BasisBits& bits) const {
  const std::uint32_t next = bits.peek(kMaxBits);
  std::uint32_t code = 0, before = 0;
  for (std::uint32_t length = 1; length <= kMaxBits; ++length) {
    code = code << 1 | (next >> (length - 1) & 1);
    if (code - first_[length] < count_[length]) {
      bits.skip(length);
      return symbols_[before + code - first_[length]];
    }
    before += count_[length];
  }
  bits.fail("a Huffman code of BasisLZ is not valid");
}

}  // namespace quintet::io
