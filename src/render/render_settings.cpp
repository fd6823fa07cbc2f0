#include "render/render_settings.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "io/codec.h"
#include "render/launch_queue.h"

namespace quintet::render {

Region checkedRegion(const RenderSettings& settings) {
  if (settings.width == 0 || settings.height == 0 || settings.width > io::kMaxImageSide ||
      settings.height > io::kMaxImageSide)
    throw UsageError(fmt::format("image size {}x{}: each side must be 1 to {} pixels", settings.width, settings.height,
                                 io::kMaxImageSide));
  const Region& r = settings.region;
  if (r.width == 0 && r.height == 0) return {0, 0, settings.width, settings.height};
  if (r.width == 0 || r.height == 0 || r.x >= settings.width || r.y >= settings.height ||
      r.width > settings.width - r.x || r.height > settings.height - r.y)
    throw UsageError(fmt::format("region {},{},{},{} is not inside the image of {}x{}", r.x, r.y, r.width, r.height,
                                 settings.width, settings.height));
  return r;
}

RenderSettings decideSettings(RenderSettings settings, const program::Program& program, const gpu::Quirks& quirks) {
  const bool accumulates = program.accumulation == program::Accumulation::program;
  if (settings.timeoutSeconds <= 0) settings.timeoutSeconds = quirks.software ? 600 : 60;
  if (settings.launchesInFlight == 0) settings.launchesInFlight = quirks.software ? 1 : LaunchQueue::kMost;
  settings.launchesInFlight = accumulates ? 1 : std::min(settings.launchesInFlight, LaunchQueue::kMost);
  return settings;
}

}  // namespace quintet::render
