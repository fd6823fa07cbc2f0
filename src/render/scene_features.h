// What a scene does without, as preprocessor definitions (quintet/features.glsl): shaders without the code
// for it compile faster and leave more registers.
#ifndef QUINTET_RENDER_SCENE_FEATURES_H
#define QUINTET_RENDER_SCENE_FEATURES_H

#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace quintet::render {

std::vector<std::pair<std::string, std::string>> featureDefines(const scene::Scene& scene, const scene::Environment& environmentInUse);

}  // namespace quintet::render
#endif
