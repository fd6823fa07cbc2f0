// SPDX-License-Identifier: Apache-2.0
// Writes JPEG, for images that are shown once and then replaced. Files that are kept are PNG, OpenEXR or Radiance HDR
// (codec.h).
#ifndef QUINTET_IO_JPEG_ENCODER_H
#define QUINTET_IO_JPEG_ENCODER_H

#include <cstddef>
#include <vector>

#include "io/image.h"

namespace quintet::io {

// Encodes u8 sRGB images with 1 or 3 channels; alpha is dropped. `quality`: 1 to 100, as in libjpeg. Throws UsageError for
// other images and for sides above 65500 pixels.
std::vector<std::byte> encodeJpeg(const Image& image, int quality);

}  // namespace quintet::io
#endif
