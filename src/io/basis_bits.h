// SPDX-License-Identifier: Apache-2.0
// Private to src/io: bits and Huffman codes of BasisLZ (KTX 2.0, section "Compressed Huffman Tables").
#ifndef QUINTET_IO_BASIS_BITS_H
#define QUINTET_IO_BASIS_BITS_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/formats.h"

namespace quintet::io {

// Reads a range of the file from the lowest bit of each byte on. Fails at its end.
class BasisBits {
 public:
  BasisBits(const Source& source, std::uint64_t offset, std::uint64_t length)
      : source_(&source), next_(offset), end_(offset + length) {}

  // At most 16 bits. Those after the end are 0.
  std::uint32_t peek(std::uint32_t count) {
    if (available_ < count) refill();
    return static_cast<std::uint32_t>(bits_ & ((std::uint64_t{1} << count) - 1));
  }
  // Bits that peek() returned.
  void skip(std::uint32_t count) {
    if (count > available_) fail("KTX2 data ends early");
    bits_ >>= count;
    available_ -= count;
  }
  std::uint32_t read(std::uint32_t count) {
    const std::uint32_t value = peek(count);
    skip(count);
    return value;
  }
  // A number in groups of `count` bits, each followed by a bit that is 1 before another group.
  std::uint32_t readGroups(std::uint32_t count);

  // Throws FileError with the location in the file.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  void refill();

  const Source* source_;
  std::uint64_t next_, end_;  // bytes of the file that are not in bits_
  std::uint64_t bits_ = 0;
  std::uint32_t available_ = 0;
};

// A canonical Huffman code as in DEFLATE (RFC 1951, section 3.2.2), with at most 16 bits for a symbol.
class BasisCode {
 public:
  // Reads the table of the code. It can have no symbols.
  explicit BasisCode(BasisBits&);
  // Reads a symbol.
  std::uint32_t operator()(BasisBits& bits) const {
    const Entry entry = short_[bits.peek(kShortBits)];
    if (entry.length == 0) return readLong(bits);
    bits.skip(entry.length);
    return entry.symbol;
  }

 private:
  static constexpr std::uint32_t kMaxBits = 16, kShortBits = 10;
  struct Entry {
    std::uint16_t symbol = 0;
    std::uint8_t length = 0;  // 0: longer than kShortBits, or invalid
  };

  // `lengths`: bits of the code of each symbol; 0 for unused ones.
  BasisCode(const BasisBits&, const std::vector<std::uint8_t>& lengths);
  std::uint32_t readLong(BasisBits&) const;

  std::vector<Entry> short_;                         // by the next bits
  std::vector<std::uint16_t> symbols_;               // in the order of their codes
  std::array<std::uint32_t, kMaxBits + 1> first_{};  // code of each length
  std::array<std::uint32_t, kMaxBits + 1> count_{};  // symbols of each length
};

}  // namespace quintet::io
#endif
