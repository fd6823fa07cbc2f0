// SPDX-License-Identifier: Apache-2.0
// Groups of adjacent pixels: what has one cause in an image is one finding.
#ifndef QUINTET_JOB_PIXEL_GROUPS_H
#define QUINTET_JOB_PIXEL_GROUPS_H

#include <cstddef>
#include <span>
#include <vector>

#include "base/math.h"

namespace quintet::job {

// Pixels that touch each other at a side or a corner, directly or through others.
struct PixelGroup {
  std::vector<std::size_t> members;  // indices of the pixels; the first one is the first in the list
  uvec2 least{0}, most{0};           // of the pixels
};

// Groups `pixels`, which are different and inside an image of this size, in the order of their first members.
std::vector<PixelGroup> groupAdjacent(uvec2 size, std::span<const uvec2> pixels);

}  // namespace quintet::job
#endif
