// scene::PrimitiveSet to the device's form.
#ifndef QUINTET_RENDER_PROCEDURAL_DATA_H
#define QUINTET_RENDER_PROCEDURAL_DATA_H

#include <vector>

#include "quintet/shared/frame.h"
#include "scene/scene.h"

namespace quintet::render {

// Index of a scene's material on the device, where the default material follows the scene's own.
std::uint32_t materialIndex(const scene::Scene& scene, int material);

std::vector<shared::PrimitiveData> makePrimitives(const scene::Scene& scene, const scene::PrimitiveSet& set);
std::vector<shared::CsgNodeData> makeNodes(const scene::PrimitiveSet& set);
std::vector<shared::CsgTreeData> makeTrees(const scene::PrimitiveSet& set);
std::vector<shared::BoxData> makeBoxes(const scene::PrimitiveSet& set);

// Boxes for the build: somewhat larger for solids and trees, because a surface that touches its box must be found
// although device and shader round differently. Custom boxes are the user's and stay.
std::vector<Bounds3> boxesForBuild(const scene::PrimitiveSet& set);

}  // namespace quintet::render
#endif
