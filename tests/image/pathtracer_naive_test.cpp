// SPDX-License-Identifier: Apache-2.0
// The path tracer against brute force: both must converge to the same image. Welch's t-test per block of
// pixels and channel, Šidák-corrected at 0.01 (Subr & Arvo 2007, "Statistical Hypothesis Testing for Assessing
// Monte Carlo Estimators"; per pixel in Mitsuba 3's test_renders.py). The test uses blocks and long batches instead of
// pixels: a pixel of `naive` finds small lights so seldom that its means are not normally distributed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>

#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"
#include "scenes.h"

namespace quintet::test {
namespace {

constexpr double kAlpha = 0.01;

struct Blocks {
  std::uint32_t columns = 0;
  std::vector<std::array<Moments, 3>> means;  // of long batches
};

// 32 long batches of `samples` in all.
Blocks render(const ImageScene& s, render::DeviceScene& device, const scene::Camera& camera,
              const program::Program& program, std::uint32_t samples, bool asRendered = false) {
  constexpr std::uint32_t kLongBatches = 32;
  ImageOptions options;
  options.program = program;
  options.set = {"bounces=8"};
  if (asRendered) options.plannedSamples = samples;
  options.width = s.width;
  options.height = s.height;
  render::Renderer renderer = makeRenderer(device, program, settingsFor(camera, options));
  Blocks blocks;
  blocks.columns = s.width / s.block;
  blocks.means.resize(std::size_t{blocks.columns} * (s.height / s.block));
  const std::uint32_t perLongBatch = std::max(1u, samples / render::kBatchSamples / kLongBatches);
  const double scale = 1.0 / (static_cast<double>(s.block * s.block) * perLongBatch * render::kBatchSamples);
  for (std::uint32_t i = 0; i < kLongBatches; ++i) {
    std::vector<glm::dvec3> sums(blocks.means.size(), glm::dvec3(0.0));
    for (std::uint32_t k = 0; k < perLongBatch; ++k) {
      renderer.renderBatch();
      const std::vector<vec4> pixels = renderer.film().downloadBatch(0);
      for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x)
          sums[std::size_t{y / s.block} * blocks.columns + x / s.block] +=
              glm::dvec3(pixels[std::size_t{y} * s.width + x]);
    }
    for (std::size_t b = 0; b < sums.size(); ++b)
      for (glm::length_t c = 0; c < 3; ++c) blocks.means[b][static_cast<std::size_t>(c)].add(scale * sums[b][c]);
  }
  EXPECT_EQ(renderer.rays().droppedSamples, 0u);
  std::printf("%s %s%s: %u samples, %.1f s, %.2f M rays\n", s.name, program.name.c_str(),
              asRendered ? " as planned" : "", kLongBatches * perLongBatch * render::kBatchSamples,
              renderer.statistics().renderSeconds, 1e-6 * static_cast<double>(renderer.rays().rays));
  return blocks;
}

// The path tracer as `render --spp` plans it. Its pixels share random numbers, so errors cancel in a block. The variance of a
// pixel's batches does not measure this. The means of blocks vary at most as much as those of independent pixels
// (BlueNoise.*, docs/measurements.md), so the test uses the variance of `independent`.
Blocks renderAsPlanned(const ImageScene& s, render::DeviceScene& device, const scene::Camera& camera,
                       const Blocks& independent) {
  Blocks blocks = render(s, device, camera, program::loadProgram("pathtracer"), s.pathtracerSamples, true);
  for (std::size_t b = 0; b < blocks.means.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c) blocks.means[b][c] = independent.means[b][c].movedTo(blocks.means[b][c].mean());
  return blocks;
}

struct Verdict {
  double smallest = 1.0;  // p-value of all blocks and channels
  std::string where;
  double whole = 1.0;  // p-value of the sum over the image, smallest of the channels
  double noise = 0.0;  // standard error of that sum, relative
  bool rejected = false;
};

Verdict compare(const Blocks& a, const Blocks& b) {
  Verdict v;
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0, variance = 0, sum = 0;
    for (std::size_t i = 0; i < a.means.size(); ++i) {
      const Moments &ma = a.means[i][c], &mb = b.means[i][c];
      const double p = pValue(ma, mb, 1e-6 * mb.mean());
      if (p < v.smallest) {
        v.smallest = p;
        v.where = "block " + std::to_string(i % a.columns) + "," + std::to_string(i / a.columns) + " channel " +
                  std::to_string(c) + ": " + std::to_string(ma.mean()) + " ± " + std::to_string(ma.standardError()) +
                  " against " + std::to_string(mb.mean()) + " ± " + std::to_string(mb.standardError());
      }
      difference += ma.mean() - mb.mean();
      variance += ma.standardError() * ma.standardError() + mb.standardError() * mb.standardError();
      sum += mb.mean();
    }
    v.whole = std::min(v.whole, studentTwoSided(difference / std::sqrt(variance), 1e6));
    v.noise = std::max(v.noise, std::sqrt(variance) / sum);
  }
  // Half of the level for the blocks, half for the whole.
  v.rejected = v.smallest < sidak(0.5 * kAlpha, 3 * a.means.size()) || v.whole < sidak(0.5 * kAlpha, 3);
  return v;
}

std::ostream& operator<<(std::ostream& out, const Verdict& v) {
  return out << "smallest p " << v.smallest << " at " << v.where << "; whole image p " << v.whole << ", its error "
             << 100 * v.noise << " %";
}

// The path tracer with MIS weights that do not add up to 1.
program::Program wrongWeights() {
  program::Program program = program::loadProgram("pathtracer");
  std::string& text = program.files.at("pathtracer.rgen");
  const std::string right = "return a / (a + b);";
  const std::size_t at = text.find(right);
  EXPECT_NE(at, std::string::npos) << "pathtracer.rgen has changed: adapt this test";
  if (at != std::string::npos) text.replace(at, right.size(), "return a / (a + 1.5 * b);");
  program.name = "wrong weights";
  return program;
}

class PathtracerAgainstNaive : public testing::TestWithParam<ImageScene> {};

TEST_P(PathtracerAgainstNaive, ConvergesToTheSameImage) {
  const ImageScene& s = GetParam();
  const SceneBuilder scene = s.make();
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const scene::Camera& camera = scene.scene.cameras.at(0);
  const Blocks naive = render(s, device, camera, program::loadProgram("naive"), s.naiveSamples);
  const Blocks independent = render(s, device, camera, program::loadProgram("pathtracer"), s.pathtracerSamples);
  const Verdict same = compare(independent, naive);
  std::cout << same << "\n";
  EXPECT_FALSE(same.rejected) << same;
  EXPECT_LT(same.noise, 0.01) << "too noisy to tell";
  if (!s.lightSamples) return;
  const Verdict planned = compare(renderAsPlanned(s, device, camera, independent), naive);
  std::cout << planned << "\n";
  EXPECT_FALSE(planned.rejected) << planned;

  // Wrong weights must be detected.
  const Verdict wrong = compare(render(s, device, camera, wrongWeights(), s.pathtracerSamples), naive);
  std::cout << wrong << "\n";
  EXPECT_TRUE(wrong.rejected) << wrong;
}

INSTANTIATE_TEST_SUITE_P(Scenes, PathtracerAgainstNaive, testing::ValuesIn(imageScenes().begin(), imageScenes().end()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace quintet::test
