// The scene for programs that are run without one.
#ifndef QUINTET_SCENE_DEFAULT_SCENE_H
#define QUINTET_SCENE_DEFAULT_SCENE_H

#include "scene/scene.h"

namespace quintet::scene {

// What the scene should consist of.
struct DefaultSceneOptions {
  bool triangles = true;  // a floor of 8 x 8 m, a sphere, a cube and a mirror ball of triangles
  bool boxes = false;     // one custom box [-1,1]³ named "boxes", for a program's own intersection shader
  bool operator==(const DefaultSceneOptions&) const = default;
};

// Small (about 3,000 triangles), with a camera, a sun and the default environment at 0.6.
Scene defaultScene(const DefaultSceneOptions& options = {});

}  // namespace quintet::scene
#endif
