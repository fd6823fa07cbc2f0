// Arrays as compressed blocks, for film files. A block's elements are split by byte: first byte 0 of all elements, then
// byte 1 and so on. The high and low words of fixed-point sums are mostly zeros, which deflate then takes away.
#ifndef QUINTET_RENDER_FILM_BLOCKS_H
#define QUINTET_RENDER_FILM_BLOCKS_H

#include <cstddef>
#include <span>
#include <vector>

namespace quintet::render {

// Appends `bytes`, whose elements have `elementBytes` each: blocks of u32 compressed size and zlib data.
void appendBlocks(std::vector<std::byte>& out, std::span<const std::byte> bytes, std::size_t elementBytes);

// Could `rawBytes` have come from so many compressed bytes at all? To be asked before memory is taken for them.
bool blocksMayHold(std::size_t rawBytes, std::size_t compressedBytes);

// Fills `bytes` from the blocks at the front of `in`, which is moved behind them. False: they are not right.
bool takeBlocks(std::span<const std::byte>& in, std::span<std::byte> bytes, std::size_t elementBytes);

}  // namespace quintet::render
#endif
