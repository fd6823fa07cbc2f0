// SPDX-License-Identifier: Apache-2.0
// The settings of a render, their defaults and limits, and the shader definitions that follow from them.
#ifndef QUINTET_RENDER_RENDERER_RENDER_SETTINGS_H
#define QUINTET_RENDER_RENDERER_RENDER_SETTINGS_H

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/buffer.h"
#include "program/description/parameter.h"
#include "program/description/program.h"
#include "render/film/film_state.h"
#include "render/renderer/shutter.h"
#include "render/scene/scene_features.h"
#include "scene/model/scene.h"

namespace quintet::render {

class ShaderLog;

// An output of this name gets what it needs to store the motion of deformed meshes and of the camera: Frame::previousPositions
// and previousCamera.
inline constexpr std::string_view kMotionOutput = "motion";

// Largest value of RenderSettings::launchesInFlight.
inline constexpr std::uint32_t kMaxLaunchesInFlight = 2;

// Seconds that a launch may take. Launches are made to take RenderSettings::launchSeconds, so one that takes this long
// probably never ends. A CPU also works for other processes.
inline constexpr double kLaunchTimeout = 60, kCpuLaunchTimeout = 120;

struct RenderSettings {
  std::uint32_t width = 1280;  // size of the whole image in pixels
  std::uint32_t height = 720;
  Region region;  // the rendered part of the image; width and height 0 mean the whole image
  scene::Camera camera;
  // Motion blur: each sample moves the scene, and the camera, to a time of its own (shutter.h). Outputs of pixel centers
  // (program::OutputPixel::center) show the middle of the interval. Not for programs that accumulate.
  std::optional<ShutterInterval> shutter;
  // The camera at a frame of the animation, for the shutter and for the output `motion`. Empty means that `camera` does not
  // move.
  std::function<scene::Camera(double frame)> cameraAt;
  std::uint32_t seed = 0;
  // How the sampler distributes samples over neighboring pixels. Like the seed, it decides the values of samples.
  // kIndependentPixels makes pixels independent, as adaptive sampling requires. 0 gives blue-noise errors that are best
  // after 2^k samples. N gives errors that are best after N samples; its first samples differ from those of other
  // values.
  std::uint32_t plannedSamples = shared::kIndependentPixels;
  bool transparent = false;  // the background has alpha 0 instead of the environment
  program::ParameterValues parameters{{}};
  // Bytes of host memory that an image of `parameters` can request; 0 means 80 % of the machine's memory.
  std::size_t maxMemory = 0;
  std::vector<std::string> outputs;  // names of the optional outputs to render
  // For benchmarks: a buffer of shared::RayKinds, then rayRecordCapacity RayRecords per pixel. Null disables recording.
  const gpu::Buffer* rayRecords = nullptr;
  std::uint32_t rayRecordCapacity = 0;
  // What the shaders of an instrumented variant of the program append to. It must outlive the renderer. Launches then take
  // one sample each. Null means no log.
  const ShaderLog* log = nullptr;
  // Number of frames of this run, for programs that accumulate (frameSize); 0 if unlimited.
  std::uint32_t frameCount = 0;
  bool instrument = false;  // the program is compiled with runtime checks, which are slow: Renderer::runtimeDiagnostics
  double launchSeconds = 0.25;  // approximate duration of a launch; launches are divided accordingly
  // A launch that takes longer throws TimeoutError; the driver's compilation does not count. 0 means the default:
  // kLaunchTimeout, or kCpuLaunchTimeout on a CPU.
  double timeoutSeconds = 0;
  // Launches that can wait on the device, so that it is never idle between them. 0 means the default: 2, or 1 on a CPU.
  // It is always 1 for programs that accumulate. The image does not depend on it.
  std::uint32_t launchesInFlight = 0;
  bool profile = false;  // record Renderer::launches, and the driver's pipeline statistics (rt::pipelineStatistics)
};

// Returns the settings with defaults resolved, and with `region` set to the rendered part of the image. Throws
// UsageError for an invalid size or region.
RenderSettings decideSettings(RenderSettings settings, const program::Program& program, bool softwareDevice);

// Returns the definitions with which a program is compiled: `extra`, those of the scene (shaderDefines), and
// QUINTET_OUTPUT_<name> for each requested optional output.
Defines renderDefines(const Defines& sceneDefines, const std::vector<std::string>& outputs, const Defines& extra = {});

}  // namespace quintet::render
#endif
