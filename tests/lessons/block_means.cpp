// SPDX-License-Identifier: Apache-2.0
#include "block_means.h"

#include <gtest/gtest.h>

#include <cmath>

#include <fmt/format.h>

#include "base/parallel.h"

namespace quintet::test {

std::vector<dvec3> hostBlocks(std::uint32_t width, std::uint32_t height, const HostPixel& pixel,
                              const BlockLimits& limits) {
  const std::uint32_t columns = width / limits.block;
  std::vector<dvec3> means(columns * (height / limits.block));
  std::vector<dvec3> rows(means.size() * limits.block, dvec3(0));
  parallelFor(rows.size(), [&](std::size_t row) {
    const std::size_t block = row / limits.block;
    HostRandom random{std::mt19937(static_cast<unsigned>(1 + row))};
    const auto y = static_cast<std::uint32_t>(block / columns * limits.block + row % limits.block);
    for (std::uint32_t i = 0; i < limits.block; ++i)
      rows[row] += pixel(static_cast<std::uint32_t>(block % columns) * limits.block + i, y, random);
  });
  for (std::size_t i = 0; i < rows.size(); ++i)
    means[i / limits.block] += rows[i] / double(limits.block * limits.block);
  return means;
}

void expectBlocks(const LessonImage& image, const std::vector<dvec3>& reference, const BlockLimits& limits) {
  const std::uint32_t columns = image.width / limits.block;
  double worst = 0;
  for (std::size_t block = 0; block < reference.size(); ++block) {
    dvec3 mean(0);
    for (std::uint32_t i = 0; i < limits.block * limits.block; ++i) {
      const vec4 c = image.at(static_cast<std::uint32_t>(block % columns) * limits.block + i % limits.block,
                              static_cast<std::uint32_t>(block / columns) * limits.block + i / limits.block);
      mean += glm::pow(glm::max(dvec3(c), 0.0), dvec3(limits.gamma)) / double(limits.block * limits.block);
    }
    for (int k = 0; k < 3; ++k) {
      const double allowed = limits.relative * reference[block][k] + limits.absolute;
      worst = std::max(worst, std::abs(mean[k] - reference[block][k]) / allowed);
      EXPECT_NEAR(mean[k], reference[block][k], allowed) << "block " << block << ", channel " << k;
    }
  }
  testing::Test::RecordProperty("worst_of_allowed", fmt::format("{:.3f}", worst));
}

}  // namespace quintet::test
