// Where a moving instance is at a frame.
#ifndef QUINTET_SCENE_KEYFRAMES_H
#define QUINTET_SCENE_KEYFRAMES_H

#include "scene/scene.h"

namespace quintet::scene {

// translate · rotate · scale.
mat4 matrixOf(const Keyframe&);

// The keyframes' matrix · keyframeFromObject: translation and scale linear, rotation spherical on the shorter way; before the first keyframe and after the last
// one the instance stands still. Without keyframes: worldFromObject.
mat4 worldFromObjectAt(const Instance&, float frame);

// Last frame at which anything changes; 0 if nothing moves.
float lastKeyframe(const Scene&);

}  // namespace quintet::scene
#endif
