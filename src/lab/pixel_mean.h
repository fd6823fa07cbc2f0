// SPDX-License-Identifier: Apache-2.0
// The mean of a block of pixels, for the checks of lesson tasks: it does not depend on the random numbers of a program as a
// single pixel does.
#ifndef QUINTET_LAB_PIXEL_MEAN_H
#define QUINTET_LAB_PIXEL_MEAN_H

#include <vector>

#include "base/math.h"
#include "io/image.h"

namespace quintet::lab {

// One number per channel. `image`: floats. The block from `begin` with `size` pixels (at least one) must be inside; else
// UsageError.
std::vector<float> pixelMean(const io::Image& image, uvec2 begin, uvec2 size);

}  // namespace quintet::lab
#endif
