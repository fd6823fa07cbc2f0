// What a rendering is asked for, and what of it is allowed.
#ifndef QUINTET_RENDER_RENDER_SETTINGS_H
#define QUINTET_RENDER_RENDER_SETTINGS_H

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/context.h"
#include "program/parameter.h"
#include "program/program.h"
#include "render/film_state.h"
#include "scene/scene.h"

namespace quintet::render {

struct CompiledShaders;

struct RenderSettings {
  std::uint32_t width = 1280;  // pixels of the whole image
  std::uint32_t height = 720;
  Region region;  // what is rendered; width 0: everything
  scene::Camera camera;
  std::uint32_t seed = 0;
  // How the sampler spreads samples over neighbouring pixels, so it belongs to what says which picture this is, as the
  // seed does. kIndependentPixels: pixels share nothing, as adaptive sampling needs it. 0: errors are blue noise, best after
  // 2^k samples. N: best after N samples; the first of them are then not those of another N.
  std::uint32_t plannedSamples = shared::kIndependentPixels;
  bool transparent = false;  // background: alpha 0 instead of the environment
  program::ParameterValues parameters{{}};
  std::vector<std::string> outputs;                          // of the program's optional ones, those to make
  std::vector<std::pair<std::string, std::string>> defines;  // for all shaders of the program
  const gpu::Buffer* rayRecords =
      nullptr;  // shared::RayKinds, then RayRecords, rayRecordCapacity per pixel: for benchmarks
  std::uint32_t rayRecordCapacity = 0;
  std::uint32_t frameCount = 0;  // frames of this run, for programs that accumulate (frameSize); 0: it has no end
  bool instrument = false;       // checks at run time, slow: Renderer::notes
  double launchSeconds = 0.25;   // a launch is cut so that it takes about this long
  // A launch that takes longer: gpu::TimeoutError. 0: 60, or 600 on a CPU, whose first launch compiles.
  double timeoutSeconds = 0;
  // Launches that may wait on the device, so that it has no gaps between them. 0: 2, or 1 on a CPU and for programs that
  // accumulate. What is chosen changes nothing in the image.
  std::uint32_t launchesInFlight = 0;
  // compileShaders() of the same program and settings: taken if the scene on the device wants the same definitions. Needed
  // during construction only.
  const CompiledShaders* compiled = nullptr;
  bool profile = false;  // Renderer::launches; keeps what the driver tells of the pipeline (rt::pipelineStatistics)
};

// The part of the image that is rendered. Throws UsageError where there is none.
Region checkedRegion(const RenderSettings& settings);

// With a value in place of each 0 that asks for one.
RenderSettings decideSettings(RenderSettings settings, const program::Program& program, const gpu::Quirks& quirks);

}  // namespace quintet::render
#endif
