// SPDX-License-Identifier: Apache-2.0
// PNG images. The checksums of the chunks are corrected, because a wrong one is rejected before the chunk is read.
#include <cstddef>
#include <vector>

#include "image_target.h"
#include "io/samples.h"

namespace quintet::fuzz {

void readInput(Input input) {
  std::vector<std::byte> png(input.begin(), input.end());
  io::test::repairPngChecksums(png);
  readImageInput(png);
}

}  // namespace quintet::fuzz
