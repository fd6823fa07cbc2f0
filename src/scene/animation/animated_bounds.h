// SPDX-License-Identifier: Apache-2.0
// The space that an animated scene needs, for cameras that show all of it.
#ifndef QUINTET_SCENE_ANIMATION_ANIMATED_BOUNDS_H
#define QUINTET_SCENE_ANIMATION_ANIMATED_BOUNDS_H

#include "scene/model/scene.h"

namespace quintet::scene {

// World-space bounds at 17 times from frame 0 to the last one, together. Without a glTF animation those of the scene
// (worldBounds). Empty without instances.
Bounds3 animatedBounds(const Scene&);

}  // namespace quintet::scene
#endif
