// SPDX-License-Identifier: Apache-2.0
// The sizes of launches over images whose pixels cost differently, on a simulated device.
#include "render/renderer/launch_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>

#include "render/film/film_state.h"

namespace quintet::render {
namespace {

struct Passes {
  double longest = 0;           // launch, seconds
  int launches = 0;             // of all passes
  double average = 0;           // launch of the last pass, seconds
  std::uint32_t unaligned = 0;  // launches of the last pass that begin at no multiple of kLaunchRows
};

// Renders `passes` batches of 16 samples as Renderer::renderStrips() does. `cost`: seconds per sample of a pixel of a row.
Passes render(LaunchSizes& sizes, std::uint32_t width, std::uint32_t height,
              const std::function<double(std::uint32_t)>& cost, int passes) {
  constexpr std::uint32_t kSamples = 16;
  Passes result;
  for (int pass = 0; pass < passes; ++pass) {
    int launches = 0;
    double total = 0;
    result.unaligned = 0;
    for (std::uint32_t row = 0; row < height;) {
      const std::uint32_t rows = sizes.rows(width, row, height, kSamples);
      EXPECT_GE(rows, 1u);
      EXPECT_LE(row + rows, height);
      double second = 0;
      for (std::uint32_t y = row; y < row + rows; ++y) second += cost(y) * width;
      const double pixels = static_cast<double>(rows) * width;
      const bool unknown = sizes.exploring();
      std::uint32_t step = !unknown && sizes.isShort(pixels * kSamples) ? kSamples : 1;
      for (std::uint32_t s = 0; s < kSamples;) {
        sizes.add(pixels * step, second * step);
        result.longest = std::max(result.longest, second * step);
        total += second * step;
        ++launches;
        s += step;
        if (unknown && s == 1 && sizes.isShort(pixels * (kSamples - 1), true)) step = kSamples - 1;
      }
      if (row % kLaunchRows != 0) ++result.unaligned;
      row += rows;
    }
    sizes.endPass(static_cast<double>(width) * height, static_cast<double>(width) * height);
    result.launches += launches;
    result.average = total / launches;
  }
  return result;
}

LaunchSizes cpu() { return {true, 1e9, 0.25}; }
LaunchSizes gpu() { return {false, 1e9, 0.25}; }

TEST(LaunchSizes, UseTheRequestedTimeOnceTheImageIsKnown) {
  LaunchSizes sizes = cpu();
  const Passes passes = render(
      sizes, 1280, 720, [](std::uint32_t) { return 5e-6; }, 4);
  EXPECT_LT(passes.longest, 0.6);
  EXPECT_GT(passes.average, 0.1);
  EXPECT_LT(passes.launches, 2000);  // launches cost a fraction of a millisecond
}

// The shader takes a millisecond for each sample: the first launch is already short.
TEST(LaunchSizes, AreShortForHeavyPrograms) {
  LaunchSizes sizes = cpu();
  EXPECT_LE(render(
                sizes, 640, 360, [](std::uint32_t) { return 1.3e-3; }, 2)
                .longest,
            1.3e-3 * 640 + 1e-9)
      << "one row";
}

// A launch of unknown pixels begins with one sample of each. The first launch has 1024 pixel samples per
// second. LaunchSizes expects a quarter of this rate, so it expects that 64 pixels take 0.25 seconds.
TEST(LaunchSizes, DivideByTheSamplesOnceTheImageIsKnown) {
  LaunchSizes sizes = cpu();
  sizes.add(512, 0.5);
  for (const std::uint32_t samples : {1u, 2u, 16u}) EXPECT_EQ(sizes.rows(4, 0, 360, samples), 16u) << samples;
  sizes.endPass(4 * 360, 4 * 360);
  EXPECT_EQ(sizes.rows(4, 0, 360, 1), 16u);
  EXPECT_EQ(sizes.rows(4, 0, 360, 2), 8u);
  EXPECT_EQ(sizes.rows(4, 0, 360, 16), 1u);
}

// A cheap sky above objects that are 50 times as slow.
TEST(LaunchSizes, AreShortWhereTheImageGetsSlow) {
  const auto cost = [](std::uint32_t row) { return row < 200 ? 2e-6 : 1e-4; };
  LaunchSizes sizes = cpu();
  EXPECT_LE(render(sizes, 640, 360, cost, 1).longest, kLongestLaunch);
  EXPECT_LE(render(sizes, 640, 360, cost, 4).longest, kLongestLaunch) << "the sky does not make them long again";
  LaunchSizes onGpu = gpu();
  EXPECT_LE(render(
                onGpu, 640, 360, [&](std::uint32_t row) { return 1e-2 * cost(row); }, 4)
                .longest,
            kLongestLaunch);
}

// Groups of 32 invocations must have the same pixels in all launches.
TEST(LaunchSizes, BeginAtMultiplesOfRowsOnGpus) {
  for (const std::uint32_t width : {640u, 1920u, 4096u, 16000u}) {
    LaunchSizes sizes = gpu();
    for (int pass = 0; pass < 3; ++pass)
      EXPECT_EQ(render(
                    sizes, width, 361, [](std::uint32_t) { return 1e-8; }, 1)
                    .unaligned,
                0u)
          << width << ' ' << pass;
  }
}

TEST(LaunchSizes, DividesLaunchesByRequest) {
  LaunchSizes sizes(true, 1e9, 1e-9);
  render(
      sizes, 16, 8, [](std::uint32_t) { return 1e-6; }, 1);
  EXPECT_EQ(sizes.rows(16, 0, 8, 16), 1u);
  EXPECT_FALSE(sizes.isShort(16));
}

// A stall of the machine is forgotten after two passes.
TEST(LaunchSizes, ForgetsOldTimes) {
  LaunchSizes sizes = cpu();
  const auto cost = [](std::uint32_t) { return 1e-6; };
  render(sizes, 640, 360, cost, 2);
  sizes.add(640, 2.0);
  EXPECT_LE(sizes.rows(640, 0, 360, 1), 1u);
  EXPECT_GT(render(sizes, 640, 360, cost, 8).average, 0.05);
}

}  // namespace
}  // namespace quintet::render
