// SPDX-License-Identifier: Apache-2.0
// Comparison of noisy images by the means of blocks of pixels, per channel; and random numbers for references on the host.
#ifndef QUINTET_TESTS_LESSON_BLOCK_MEANS_H
#define QUINTET_TESTS_LESSON_BLOCK_MEANS_H

#include <random>

#include "lesson.h"

namespace quintet::test {

struct HostRandom {
  std::mt19937 engine;
  double operator()() { return std::uniform_real_distribution<double>(0, 1)(engine); }
  dvec3 unit() {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(engine), normal(engine), normal(engine)));
  }
};

// The radiance of a pixel, an estimate with its own random numbers or an exact value. (0, 0) is the bottom left.
using HostPixel = std::function<dvec3(std::uint32_t x, std::uint32_t y, HostRandom& random)>;

struct BlockLimits {
  std::uint32_t block = 8;  // side in pixels; the image is a multiple of it
  double relative = 0.03;   // largest difference of a channel of a block, relative to the reference
  double absolute = 1e-3;   // and in addition
  double gamma = 2.2;       // the values of the lesson are linear values to the power 1 / gamma
};

// Returns the means of the reference, row by row from the bottom.
std::vector<dvec3> hostBlocks(std::uint32_t width, std::uint32_t height, const HostPixel& pixel,
                              const BlockLimits& limits = {});
void expectBlocks(const LessonImage& image, const std::vector<dvec3>& reference, const BlockLimits& limits = {});

}  // namespace quintet::test
#endif
