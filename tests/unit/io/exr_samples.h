// SPDX-License-Identifier: Apache-2.0
// An image with every kind of channel for the tests of OpenEXR files.
#ifndef QUINTET_TESTS_IO_EXR_SAMPLES_H
#define QUINTET_TESTS_IO_EXR_SAMPLES_H

#include <cstdint>

#include "io/exr/exr.h"

namespace quintet::io::test {

// Colors: R, G, B, A and albedo (values from 0 to 4 that are exact as half). Data as floats: normal, depth with
// infinity, uv and a Cryptomatte layer. exact.id has integers above 2^24.
ExrImage layeredImage(std::uint32_t width, std::uint32_t height);

}  // namespace quintet::io::test
#endif
