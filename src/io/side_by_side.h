// SPDX-License-Identifier: Apache-2.0
// Two images and their difference side by side, for visual comparison.
#ifndef QUINTET_IO_SIDE_BY_SIDE_H
#define QUINTET_IO_SIDE_BY_SIDE_H

#include "io/image.h"

namespace quintet::io {

// A, B and `difference` (8-bit RGB) of the same size, from left to right. Transparent pixels show a dark gray background.
Image sideBySide(const Image& a, const Image& b, const Image& difference);

}  // namespace quintet::io
#endif
