// Private to src/io: what the measures in compare.h are taken of.
#ifndef QUINTET_IO_COMPARE_INPUT_H
#define QUINTET_IO_COMPARE_INPUT_H

#include "io/image.h"

namespace quintet::io {

// FLIP of two pictures that are linear RGB floats in [0,1] of one size.
Image flipOfDisplayable(const Image& a, const Image& b, float pixelsPerDegree);

}  // namespace quintet::io
#endif
