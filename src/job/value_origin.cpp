// SPDX-License-Identifier: Apache-2.0
#include "job/value_origin.h"

#include <utility>

#include "job/device_limits.h"
#include "job/runnable_program.h"

namespace quintet::job {
namespace {

constexpr std::uint32_t kValueLogWords = 1u << 18;

// Files of the library are not in the folder of the program: "<quintet/…>".
bool isInLibrary(const program::ValueSite& site) {
  return site.location.file.empty() || site.location.file.find("quintet/") != std::string::npos;
}

}  // namespace

ValueOriginFinder::ValueOriginFinder(Engine& engine, render::DeviceScene& scene, const program::Program& program,
                                     const std::vector<std::string>& outputs, render::RenderSettings settings,
                                     uvec2 pixel)
    : log_(scene.context(), {pixel.x, pixel.y, 1, 1}, kValueLogWords) {
  const render::Defines defines = render::renderDefines(scene.defines(), outputs);
  CheckedProgram checked =
      compileAndCheck(program, engine.compiler(), defines, scene.facts(), deviceLimits(scene.context().info()));
  sites_ = addValueProbes(checked, engine.compiler(), defines);
  settings.log = &log_;
  settings.instrument = false;
  renderer_ =
      std::make_unique<render::Renderer>(scene, std::move(checked.runnable), engine.compiler(), nullptr, settings);
}

std::optional<ValueOrigin> ValueOriginFinder::find(const std::function<void(render::Renderer&)>& render) {
  log_.take();
  render(*renderer_);
  renderer_->finish();
  const render::LogContents log = log_.take();
  std::optional<ValueOrigin> inLibrary;
  for (const render::LogRecord& record : log.records) {
    if (record.kind != shared::kLogValue || record.wordCount != 2) continue;
    const auto words = log.wordsOf(record);
    if (words[0] >= sites_.size()) continue;
    const program::ValueSite& site = sites_[words[0]];
    ValueOrigin origin{site.location, site.stage, site.operation, words[1] != 0};
    if (!isInLibrary(site)) return origin;
    if (!inLibrary) inLibrary = std::move(origin);
  }
  return inLibrary;
}

}  // namespace quintet::job
