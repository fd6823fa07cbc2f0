// SPDX-License-Identifier: Apache-2.0
#include "rendered_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "harness.h"
#include "job/device_limits.h"
#include "job/runnable_program.h"

namespace quintet::test {
namespace {

constexpr double kAlpha = 0.01;

// Expects a mean; the message says where and by how much it is wrong.
void expectMean(const std::string& where, const Moments& m, double exact, double level, double rounding) {
  const double p = pValue(m, exact, rounding * std::abs(exact) + 1e-7);
  EXPECT_GE(p, level) << where << ": " << m.mean() << " ± " << m.standardError() << " instead of " << exact
                      << " (p = " << p << ")";
}

// Returns the mean over the renderer's filter, in parts of equal weight.
glm::dvec3 filtered(const std::function<vec3(vec2)>& exact, vec2 center) {
  constexpr int kParts = 12;
  const auto offset = [](int i) {
    const float v = 2.0f * (static_cast<float>(i) + 0.5f) / kParts - 1.0f;
    return 0.75f * (v < 0.0f ? std::sqrt(1.0f + v) - 1.0f : 1.0f - std::sqrt(1.0f - v));
  };
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kParts; ++i)
    for (int k = 0; k < kParts; ++k) sum += glm::dvec3(exact(center + vec2(offset(i), offset(k))));
  return sum / static_cast<double>(kParts * kParts);
}

std::string pixelName(std::uint32_t x, std::uint32_t y, std::size_t c) {
  return "pixel " + std::to_string(x) + "," + std::to_string(y) + " channel " + std::to_string(c);
}

}  // namespace

const shader::Compiler& testCompiler() {
  static const shader::Compiler compiler{shader::CompilerOptions{.cacheFolder = shaderCache()}};
  return compiler;
}

render::RenderSettings settingsFor(const scene::Camera& camera, const ImageOptions& options) {
  render::RenderSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.camera = camera;
  settings.seed = options.seed;
  settings.plannedSamples = options.plannedSamples;
  settings.transparent = options.transparent;
  settings.timeoutSeconds = 600;
  settings.parameters = program::ParameterValues(options.program.parameters);
  for (const std::string& assignment : options.set) settings.parameters.setAssignment(assignment);
  return settings;
}

void RenderedImage::addBatch(const std::vector<vec4>& sums, std::uint32_t samples) {
  for (std::size_t i = 0; i < channels_.size(); ++i)
    channels_[i].add(static_cast<double>(sums[i / 4][static_cast<glm::length_t>(i % 4)]) / samples);
}

render::Renderer makeRenderer(render::DeviceScene& scene, const program::Program& program,
                              const render::RenderSettings& settings, const render::Defines& defines) {
  job::CheckedProgram checked =
      job::compileAndCheck(program, testCompiler(), render::renderDefines(scene.defines(), settings.outputs, defines),
                           scene.facts(), job::deviceLimits(scene.context().info()),
                           settings.instrument ? program::Instrumentation::checks : program::Instrumentation::none);
  return render::Renderer(scene, std::move(checked.runnable), testCompiler(), nullptr, settings);
}

RenderedImage renderImage(const SceneBuilder& scene, const ImageOptions& options) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras.at(0), options));
  RenderedImage image(options.width, options.height);
  for (std::uint32_t i = 0; i < options.batches; ++i) {
    renderer.renderBatch();
    image.addBatch(renderer.film().downloadBatch(0), render::kBatchSamples);
  }
  const render::RayCount count = renderer.rays();
  image.rays = count.rays;
  image.droppedSamples = count.droppedSamples;
  EXPECT_GT(image.rays, 0u);
  EXPECT_EQ(image.droppedSamples, 0u);
  return image;
}

Layers renderLayers(render::DeviceScene& device, const scene::Scene& scene, const program::Program& program,
                    const std::vector<std::string>& outputs) {
  ImageOptions options;
  options.width = 76;  // lavapipe: not a multiple of the columns that an invocation of the path tracer renders
  options.height = 30;
  options.program = program;
  render::RenderSettings settings = settingsFor(scene.cameras.at(0), options);
  settings.outputs = outputs;
  render::Renderer renderer = makeRenderer(device, program, settings);
  renderer.renderBatch();
  Layers layers;
  for (std::size_t i = 0; i < program.outputs.size(); ++i) {
    const std::string& name = program.outputs[i].name;
    if (name == "color" || std::ranges::count(outputs, name)) layers.planes.push_back(renderer.film().downloadBatch(i));
  }
  layers.rays = renderer.rays().rays;
  return layers;
}

void expectUniform(const RenderedImage& image, const vec4& exact, const Tolerance& tolerance) {
  const std::size_t pixels = std::size_t{image.width()} * image.height();
  for (std::size_t c = 0; c < 4; ++c) {
    const double value = exact[static_cast<glm::length_t>(c)];
    Moments whole;
    for (std::uint32_t y = 0; y < image.height(); ++y) {
      for (std::uint32_t x = 0; x < image.width(); ++x) {
        const Moments& m = image.at(x, y, c);
        whole.add(m.mean());
        expectMean(pixelName(x, y, c), m, value, sidak(kAlpha, 4 * pixels), tolerance.rounding);
      }
    }
    expectMean("mean of channel " + std::to_string(c), whole, value, sidak(kAlpha, 4), tolerance.rounding);
    EXPECT_LE(whole.standardError(), tolerance.error * value + 1e-7) << "too noisy for this test, channel " << c;
  }
}

void expectPixels(const RenderedImage& image, const std::function<vec3(vec2)>& exact, const Tolerance& tolerance) {
  const std::size_t tests = std::size_t{3} * image.width() * image.height();
  std::vector<glm::dvec3> values;
  for (std::uint32_t y = 0; y < image.height(); ++y)
    for (std::uint32_t x = 0; x < image.width(); ++x) values.push_back(filtered(exact, vec2(x, y) + 0.5f));
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0.0, variance = 0.0, sum = 0.0;
    for (std::uint32_t y = 0; y < image.height(); ++y) {
      for (std::uint32_t x = 0; x < image.width(); ++x) {
        const double value = values[std::size_t{y} * image.width() + x][static_cast<glm::length_t>(c)];
        const Moments& m = image.at(x, y, c);
        expectMean(pixelName(x, y, c), m, value, sidak(kAlpha, tests), tolerance.rounding);
        difference += m.mean() - value;
        variance += m.standardError() * m.standardError();
        sum += value;
      }
    }
    const double error = std::sqrt(variance);
    const double z = std::max(0.0, std::abs(difference) - tolerance.rounding * sum) / std::max(error, 1e-12);
    EXPECT_GE(studentTwoSided(z, 1e6), sidak(kAlpha, 3))
        << "channel " << c << ": sum wrong by " << difference << " ± " << error << " of " << sum;
    EXPECT_LE(error, tolerance.error * sum + 1e-7) << "too noisy for this test, channel " << c;
  }
}

void expectBlack(const RenderedImage& image) {
  for (std::uint32_t y = 0; y < image.height(); ++y) {
    for (std::uint32_t x = 0; x < image.width(); ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Moments& m = image.at(x, y, c);
        EXPECT_TRUE(m.mean() == 0.0 && m.variance() == 0.0) << pixelName(x, y, c) << " has " << m.mean();
      }
    }
  }
}

}  // namespace quintet::test
