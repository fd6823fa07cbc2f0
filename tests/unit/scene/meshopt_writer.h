// SPDX-License-Identifier: Apache-2.0
// Writes streams of version 1 of meshoptimizer's vertex codec in tests. Of several ways to store a group of bytes it takes one
// at random, so that many streams have all of them.
#ifndef QUINTET_TESTS_MESHOPT_WRITER_H
#define QUINTET_TESTS_MESHOPT_WRITER_H

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace quintet::test {

// `modes`: that of each channel of four bytes: 0, 1, or 2 plus 16 times a rotation.
std::vector<unsigned char> writeMeshoptVersion1(const std::vector<unsigned char>& elements, std::size_t stride,
                                                const std::vector<unsigned char>& modes, std::mt19937& random);

}  // namespace quintet::test
#endif
