// SPDX-License-Identifier: Apache-2.0
#include "job/scene_notes.h"

#include <string>

#include <fmt/format.h>

#include "base/file.h"
#include "base/plural.h"
#include "base/text.h"
#include "scene/defaults/default_environment.h"

namespace quintet::job {
namespace {

// States which environment was chosen for a scene without one, and how to choose another.
void noteLight(const std::string& scene, scene::OwnLight light, Observer& observer) {
  switch (light) {
    case scene::OwnLight::none:
      observer.note(fmt::format(
          "{}: no lights in the scene, using the default environment (the environment 'none' disables it)", scene));
      break;
    case scene::OwnLight::faint:
      observer.note(
          fmt::format("{}: its own lights leave most of the scene dark, using the default environment (the environment "
                      "'none' disables it)",
                      scene));
      break;
    case scene::OwnLight::emission:
      observer.note(fmt::format(
          "{}: emissive surfaces light the scene, using no environment (the environment 'default' adds one)", scene));
      break;
    case scene::OwnLight::punctual: break;
  }
}

}  // namespace

void noteScene(const LoadedScene& loaded, const ResolvedJob& job, Observer& observer) {
  const std::string& name = job.scene.name;
  // Lecture programs bring their own lights.
  if (loaded.environment.decidedBy && !job.accumulatesFrames())
    noteLight(name, *loaded.environment.decidedBy, observer);
  if (!loaded.environment.repair.empty()) observer.warning(loaded.environment.repair);
  if (loaded.scene.instances.empty()) observer.warning(fmt::format("{}: the scene has no surfaces", name));
  const scene::Report& report = loaded.scene.report;
  if (!report.animations.empty() && !loaded.scene.nodeAnimation)
    observer.note(fmt::format("{}: rendered in its rest pose; the file has {}", name,
                              counted(report.animations.size(), "animation")));
  if (!report.isExact())
    observer.note(fmt::format("{}: {} ignored, {} repaired; 'quintet info {}' lists them", name, report.ignored.size(),
                              report.repaired.size(), shellQuoted(job.scene.path())));
}

}  // namespace quintet::job
