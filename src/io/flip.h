// SPDX-License-Identifier: Apache-2.0
// Private to src/io: LDR-FLIP, the perceptual error metric behind compare.h.
#ifndef QUINTET_IO_FLIP_H
#define QUINTET_IO_FLIP_H

#include "io/image.h"

namespace quintet::io {

// Returns the FLIP error per pixel (f32, 1 channel, [0,1]) of two linear RGB float images in [0,1] of the same size.
Image flipOfDisplayable(const Image& a, const Image& b, float pixelsPerDegree);

}  // namespace quintet::io
#endif
