// SPDX-License-Identifier: Apache-2.0
// Writes images in ETC1S with BasisLZ in tests. The writer takes what the format offers, often at random, instead of what is
// small: its purpose is to use every kind of symbol.
#ifndef QUINTET_TESTS_IO_BASIS_LZ_BUILDER_H
#define QUINTET_TESTS_IO_BASIS_LZ_BUILDER_H

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "io/ktx2_builder.h"

namespace quintet::io::test {

// Writes bits, the lowest one of each byte first.
class BasisBitWriter {
 public:
  BasisBitWriter& operator()(std::uint32_t value, std::size_t count);
  // Groups of `count` bits, each followed by a bit that is 1 before another group.
  BasisBitWriter& groups(std::uint32_t value, std::uint32_t count);
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

// A canonical Huffman code for `symbols` symbols. A skewed one has long codes for most of them.
class BasisCodeWriter {
 public:
  BasisCodeWriter(std::size_t symbols, bool skewed);
  explicit BasisCodeWriter(std::vector<std::uint8_t> lengths) : lengths_(std::move(lengths)) {}
  void writeTable(BasisBitWriter&) const;
  void write(BasisBitWriter&, std::uint32_t symbol) const;

 private:
  std::vector<std::uint8_t> lengths_;
};

struct EtcEndpoint {
  std::array<std::uint32_t, 3> color{};  // 5 bits each
  std::uint32_t intensity = 0;           // 0 to 7
};

// Indices of a block.
struct EtcBlock {
  std::uint32_t endpoint = 0, selector = 0;
};

struct BasisLzImage {
  std::uint32_t width = 4, height = 4;
  std::vector<EtcEndpoint> endpoints;
  std::vector<std::uint32_t> selectors;       // two bits for each texel, in rows
  std::vector<std::vector<EtcBlock>> slices;  // one or two

  // How the image is written.
  bool gray = false, rawSelectors = false, skewed = false;
  std::uint32_t historySize = 0;
  std::uint32_t flags = 0;  // of the image

  // Endpoints, selectors and blocks at random; many blocks repeat others.
  void fill(std::mt19937& random, std::size_t endpointCount, std::size_t selectorCount, std::size_t sliceCount);
  // Channel c of a pixel of a slice.
  std::uint8_t value(std::size_t slice, std::uint32_t x, std::uint32_t y, std::size_t c) const;
  // `channels` are those of the data format descriptor.
  Ktx2 file(std::mt19937& random, std::initializer_list<int> channels) const;
};

}  // namespace quintet::io::test
#endif
