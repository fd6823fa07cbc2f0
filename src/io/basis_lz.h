// SPDX-License-Identifier: Apache-2.0
// Private to src/io: images in ETC1S with the supercompression BasisLZ (KTX 2.0, appendices "BasisLZ Global Data" and
// "BasisLZ/ETC1S Bitstream Specification").
#ifndef QUINTET_IO_BASIS_LZ_H
#define QUINTET_IO_BASIS_LZ_H

#include <cstddef>
#include <cstdint>

#include "io/formats.h"
#include "io/image.h"

namespace quintet::io {

// Where the parts of the first image are in a file.
struct BasisLzLayout {
  std::uint64_t globalOffset = 0, globalLength = 0;
  std::uint64_t levelOffset = 0, levelLength = 0;
  std::uint32_t images = 1;  // of the file: its mip levels
  std::uint32_t width = 0, height = 0;
  bool twoSlices = false;  // the second one is the fourth channel
};

// The largest number of bytes that decodeBasisLz() needs for a while, besides the image.
std::size_t basisLzMemory(const BasisLzLayout&);

// The first image with `channels` (1, 3 or 4) of the channels red, green, blue, and the value of the second slice. Throws
// FileError.
Image decodeBasisLz(const Source&, const BasisLzLayout&, std::uint32_t channels);

}  // namespace quintet::io
#endif
