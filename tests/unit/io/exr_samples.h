// A picture with every kind of channel, for the tests of OpenEXR files.
#ifndef QUINTET_TESTS_IO_EXR_SAMPLES_H
#define QUINTET_TESTS_IO_EXR_SAMPLES_H

#include "io/exr.h"

namespace quintet::io::test {

// Colours R, G, B, A and albedo (halfs that are exact in half; values from 0 to 4); data as floats: normal, depth with
// infinity, uv, a Cryptomatte layer; exact.id as integers beyond 2^24.
ExrPicture layeredPicture(std::uint32_t width, std::uint32_t height);

}  // namespace quintet::io::test
#endif
