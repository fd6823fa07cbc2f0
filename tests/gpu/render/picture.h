// Renders a small image and keeps what the tests ask for: mean and standard error of each pixel, from the
// film's batches. The batches of one pixel share a low-discrepancy sequence, so they vary more than
// independent ones with the same total error: a standard error from them is too large rather than too small.
#ifndef QUINTET_TESTS_GPU_RENDER_PICTURE_H
#define QUINTET_TESTS_GPU_RENDER_PICTURE_H

#include <functional>
#include <string>
#include <vector>

#include "render/renderer.h"
#include "scene_builder.h"
#include "statistics.h"

namespace quintet::test {

// One for the process; results are cached in a folder that is removed at exit.
const shader::Compiler& testCompiler();

struct PictureOptions {
  program::Program program = program::loadProgram("pathtracer");
  std::vector<std::string> set;  // parameters, "bounces=1"
  std::uint32_t width = 8;
  std::uint32_t height = 8;
  std::uint32_t batches = 16;  // of render::kBatchSamples samples
  std::uint32_t seed = 1;
  // RenderSettings::plannedSamples. What takes pixels for independent draws (errors of means over pixels) needs this default;
  // `quintet render` without --adaptive plans its --spp, or 0.
  std::uint32_t plannedSamples = shared::kIndependentPixels;
  bool transparent = false;
};

render::RenderSettings settingsFor(const scene::Camera& camera, const PictureOptions& options);

class Picture {
 public:
  Picture(std::uint32_t width, std::uint32_t height)
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

Picture renderPicture(const SceneBuilder& scene, const PictureOptions& options = {});

struct Tolerance {
  double error = 0.01;     // the standard error of the image's mean must be below this part of it
  double rounding = 2e-5;  // part of the exact value that float arithmetic may be wrong by
};

// Each pixel has this value: per pixel, and on the mean over all pixels, whose scatter gives its error.
void expectUniform(const Picture& picture, const vec4& exact, const Tolerance& tolerance = {});

// Each pixel is exact(position in pixels; centres at .5), blurred by the renderer's filter: a tent of radius 0.75.
void expectPixels(const Picture& picture, const std::function<vec3(vec2)>& exact, const Tolerance& tolerance = {});

// Every sample of every colour channel was exactly 0.
void expectBlack(const Picture& picture);

}  // namespace quintet::test
#endif
