// SPDX-License-Identifier: Apache-2.0
// Private to src/io: decoders of the block-compressed formats BC1 to BC7 and UASTC (Khronos Data Format Specification 1.4,
// chapters 18 to 20 and 25). Blocks of 4 x 4 texels are in rows from the top; those at the right and bottom edges can exceed the image.
#ifndef QUINTET_IO_BLOCK_DECODE_H
#define QUINTET_IO_BLOCK_DECODE_H

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/image.h"

namespace quintet::io {

enum class BlockFormat : std::uint8_t {
  none,
  bc1Rgb,
  bc1Rgba,
  bc2,
  bc3,
  bc4,
  bc4Signed,
  bc5,
  bc5Signed,
  bc6,
  bc6Signed,
  bc7,
  uastc
};

// Bytes of a block of 4 x 4 texels.
std::size_t bytesPerBlock(BlockFormat format);

// Type and channels of the decoded image: u8 for BC1, BC2, BC3, BC7 and UASTC; u16 for BC4 and BC5, whose values have more than
// 8 bits; f32 for signed formats and BC6H. BC4 has 1 channel, BC5 has red, green and a blue of 0.
ImageInfo blockImageInfo(BlockFormat format, std::uint32_t width, std::uint32_t height);

// Decodes on all cores. `blocks` has ceil(width / 4) · ceil(height / 4) blocks. The image has the first `channels` of
// those of the format.
Image decodeBlocks(BlockFormat format, std::span<const std::byte> blocks, std::uint32_t width, std::uint32_t height,
                   std::uint32_t channels = 4);

// One block each, texels in rows. RGBA: 16 · 4 values.
void decodeBc7Block(const std::byte* block, std::uint8_t* rgba);
void decodeUastcBlock(const std::byte* block, std::uint8_t* rgba);
// RGB: 16 · 3 values.
void decodeBc6Block(const std::byte* block, bool isSigned, float* rgb);

}  // namespace quintet::io
#endif
