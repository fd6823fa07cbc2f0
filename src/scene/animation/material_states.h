// SPDX-License-Identifier: Apache-2.0
// The states of an animated material, from which a renderer chooses the shader code that it needs.
#ifndef QUINTET_SCENE_ANIMATION_MATERIAL_STATES_H
#define QUINTET_SCENE_ANIMATION_MATERIAL_STATES_H

#include <span>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

// Some states of a material during the animation, for Scene::materialStates: each combination of features that it has at
// any time, one of them has. A feature depends on the signs of values, on whether they are 1, and on whether the
// roughness is that of a pane (isPane). The times at which this changes are found on each interval of each sampler, also
// where a cubic spline is above 0 only between its keys. Includes the largest emission at and between all times.
std::vector<Material> materialStates(const Material&, std::span<const AnimatedValue>, const NodeAnimation&);

}  // namespace quintet::scene
#endif
