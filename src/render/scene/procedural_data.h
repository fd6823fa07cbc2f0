// SPDX-License-Identifier: Apache-2.0
// Conversion of scene::PrimitiveSet to the device's form.
#ifndef QUINTET_RENDER_SCENE_PROCEDURAL_DATA_H
#define QUINTET_RENDER_SCENE_PROCEDURAL_DATA_H

#include <vector>

#include "quintet/shared/frame.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Returns the index of a scene's material on the device. The default material follows those of the scene.
std::uint32_t materialIndex(const scene::Scene& scene, int material);

std::vector<shared::PrimitiveData> makePrimitives(const scene::Scene& scene, const scene::PrimitiveSet& set);
std::vector<shared::CsgNodeData> makeNodes(const scene::PrimitiveSet& set);
std::vector<shared::CsgTreeData> makeTrees(const scene::PrimitiveSet& set);
std::vector<shared::BoxData> makeBoxes(const scene::PrimitiveSet& set);

// Returns the boxes for the acceleration structure build. Boxes of solids and CSG trees are slightly enlarged, because
// a surface that touches its box must be found although device and shader round differently. Custom boxes are returned
// unchanged.
std::vector<Bounds3> boxesForBuild(const scene::PrimitiveSet& set);

}  // namespace quintet::render
#endif
