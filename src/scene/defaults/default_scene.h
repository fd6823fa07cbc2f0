// SPDX-License-Identifier: Apache-2.0
// The built-in scene for programs that run without a scene file.
#ifndef QUINTET_SCENE_DEFAULTS_DEFAULT_SCENE_H
#define QUINTET_SCENE_DEFAULTS_DEFAULT_SCENE_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Contents of the scene.
struct DefaultSceneOptions {
  bool triangles = true;  // a floor of 8 x 8 m, a sphere, a cube and a mirror sphere, all of triangles
  bool boxes = false;     // one custom box [-1,1]³ named "boxes", for the intersection shader of a program
  bool operator==(const DefaultSceneOptions&) const = default;
};

// About 3,000 triangles, a camera, a sun and the default environment.
Scene defaultScene(const DefaultSceneOptions& options = {});

}  // namespace quintet::scene
#endif
