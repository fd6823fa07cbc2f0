// SPDX-License-Identifier: Apache-2.0
// Renders small images for tests, and computes the mean and standard error of each pixel from the film's batches. The
// batches of a pixel share a low-discrepancy sequence, so they vary more than independent batches with the same total
// error: the standard errors are too large rather than too small.
#ifndef QUINTET_TESTS_GPU_RENDER_RENDERED_IMAGE_H
#define QUINTET_TESTS_GPU_RENDER_RENDERED_IMAGE_H

#include <functional>
#include <string>
#include <vector>

#include "program/load.h"
#include "render/renderer/renderer.h"
#include "scene_builder.h"
#include "statistics.h"

namespace quintet::test {

// The compiler of this process, with shaderCache().
const shader::Compiler& testCompiler();

struct ImageOptions {
  program::Program program = program::loadProgram("pathtracer");
  std::vector<std::string> set;  // assignments to parameters: "bounces=1"
  std::uint32_t width = 8;
  std::uint32_t height = 8;
  std::uint32_t batches = 16;  // of render::kBatchSamples samples
  std::uint32_t seed = 1;
  // RenderSettings::plannedSamples. Tests that treat pixels as independent (errors of means over pixels) need this
  // default. `quintet render` without --adaptive uses its --spp, or 0.
  std::uint32_t plannedSamples = shared::kIndependentPixels;
  bool transparent = false;
};

render::RenderSettings settingsFor(const scene::Camera& camera, const ImageOptions& options);

// Compiles and checks the program for the scene with `defines` in addition. Throws ProgramError.
render::Renderer makeRenderer(render::DeviceScene& scene, const program::Program& program,
                              const render::RenderSettings& settings, const render::Defines& defines = {});

class RenderedImage {
 public:
  RenderedImage(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), channels_(std::size_t{4} * width * height) {}
  void addBatch(const std::vector<vec4>& sums, std::uint32_t samples);

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  const Moments& at(std::uint32_t x, std::uint32_t y, std::size_t channel) const {
    return channels_[(std::size_t{y} * width_ + x) * 4 + channel];
  }

  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;

 private:
  std::uint32_t width_;
  std::uint32_t height_;
  std::vector<Moments> channels_;
};

RenderedImage renderImage(const SceneBuilder& scene, const ImageOptions& options = {});

// Outputs of one batch with 48x48 pixels, in the order of the program: the color, and the requested ones.
struct Layers {
  std::vector<std::vector<vec4>> planes;
  std::uint64_t rays = 0;
};
Layers renderLayers(render::DeviceScene& device, const scene::Scene& scene, const program::Program& program,
                    const std::vector<std::string>& outputs = {});

struct Tolerance {
  double error = 0.01;     // largest standard error of the image's mean, relative to the mean
  double rounding = 2e-5;  // largest rounding error of float arithmetic, relative to the exact value
};

// Expects this value in each pixel, and as the mean over all pixels, whose error follows from their variation.
void expectUniform(const RenderedImage& image, const vec4& exact, const Tolerance& tolerance = {});

// Expects exact(position in pixels; pixel centers are at .5) in each pixel, blurred by the renderer's filter: a tent of
// radius 0.75.
void expectPixels(const RenderedImage& image, const std::function<vec3(vec2)>& exact, const Tolerance& tolerance = {});

// Expects every sample of every color channel to be exactly 0.
void expectBlack(const RenderedImage& image);

}  // namespace quintet::test
#endif
