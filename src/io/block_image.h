// SPDX-License-Identifier: Apache-2.0
// Images in the block-compressed formats BC1 to BC7 (Khronos Data Format Specification 1.3, chapters 18 to 20), which
// devices can sample without decoding.
#ifndef QUINTET_IO_BLOCK_IMAGE_H
#define QUINTET_IO_BLOCK_IMAGE_H

#include <cstddef>
#include <cstdint>
#include <vector>

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
  bc7
};

// Blocks of 4 x 4 texels, in rows from the top; blocks at the right and bottom edges can exceed the image.
struct BlockImage {
  BlockFormat format = BlockFormat::none;
  bool sRgb = false;  // colors are sRGB-encoded
  std::vector<std::byte> data;
  bool empty() const { return data.empty(); }
};

}  // namespace quintet::io
#endif
