// SPDX-License-Identifier: Apache-2.0
// What a scene does without, as preprocessor definitions (quintet/features.glsl): shaders without the code
// for it compile faster and leave more registers.
#ifndef QUINTET_RENDER_SCENE_SCENE_FEATURES_H
#define QUINTET_RENDER_SCENE_SCENE_FEATURES_H

#include <string>
#include <utility>
#include <vector>

#include "gpu/context.h"
#include "scene/model/scene.h"

namespace quintet::render {

using Defines = std::vector<std::pair<std::string, std::string>>;

// What shaders must know of a scene. Of an image, only the number of channels matters.
struct SceneFeatures {
  Defines defines;     // QUINTET_NO_…
  bool alpha = false;  // any geometry needs an alpha test
  bool boxes = false;  // any geometry has an intersection shader
  bool panes = false;  // any geometry is a pane
  bool operator==(const SceneFeatures&) const = default;
};
SceneFeatures sceneFeatures(const scene::Scene& scene, const scene::Environment& environmentInUse);

// With the workarounds for a device.
Defines shaderDefines(const SceneFeatures& features, const gpu::Quirks& quirks);

}  // namespace quintet::render
#endif
