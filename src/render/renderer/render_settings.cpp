// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/render_settings.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

Region validRegion(const RenderSettings& settings) {
  if (settings.width == 0 || settings.height == 0 || settings.width > io::kMaxImageSide ||
      settings.height > io::kMaxImageSide)
    throw UsageError(fmt::format("image size {}x{}: each side must be 1 to {} pixels", settings.width, settings.height,
                                 io::kMaxImageSide));
  const Region& r = settings.region;
  if (r.width == 0 && r.height == 0) return {0, 0, settings.width, settings.height};
  if (r.width == 0 || r.height == 0 || r.x >= settings.width || r.y >= settings.height ||
      r.width > settings.width - r.x || r.height > settings.height - r.y) {
    const std::string part = r.width == 1 && r.height == 1
                                 ? fmt::format("pixel {},{}", r.x, r.y)
                                 : fmt::format("region {},{},{},{}", r.x, r.y, r.width, r.height);
    throw UsageError(fmt::format("{} is not inside the image of {}x{}", part, settings.width, settings.height));
  }
  return r;
}

}  // namespace

RenderSettings decideSettings(RenderSettings settings, const program::Program& program, bool softwareDevice) {
  const bool accumulates = program.accumulation == program::Accumulation::program;
  settings.region = validRegion(settings);
  if (settings.timeoutSeconds <= 0) settings.timeoutSeconds = softwareDevice ? kCpuLaunchTimeout : kLaunchTimeout;
  if (settings.launchesInFlight == 0) settings.launchesInFlight = softwareDevice ? 1 : kMaxLaunchesInFlight;
  settings.launchesInFlight = accumulates ? 1 : std::min(settings.launchesInFlight, kMaxLaunchesInFlight);
  if (settings.parameters.parameters().empty()) settings.parameters = program::ParameterValues(program.parameters);
  return settings;
}

Defines renderDefines(const Defines& sceneDefines, const std::vector<std::string>& outputs, const Defines& extra) {
  Defines defines = extra;
  defines.insert(defines.end(), sceneDefines.begin(), sceneDefines.end());
  for (const std::string& output : outputs) defines.emplace_back(program::outputMacro(output), "1");
  return defines;
}

}  // namespace quintet::render
