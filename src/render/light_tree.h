// The tree from which lights are drawn (shared::LightNode, quintet/lights/tree.glsl): built top down by the surface
// area orientation heuristic of Conty Estevez and Kulla 2018, section 4.4, on all cores, the same whatever their number.
#ifndef QUINTET_RENDER_LIGHT_TREE_H
#define QUINTET_RENDER_LIGHT_TREE_H

#include <vector>

#include "quintet/shared/frame.h"
#include "render/light_bounds.h"

namespace quintet::render {

enum class LightReach : std::uint8_t { finite, directional, environment };

struct LightTreeInput {
  LightBounds bounds;
  std::uint32_t light = 0;  // index in LightTable::lights
  LightReach reach = LightReach::finite;
};

struct LightTree {
  std::vector<shared::LightNode> nodes;  // node 1 is not used: pairs begin at even indices
  std::vector<std::uint32_t> leaves;     // per light: its node, or kNoLight
};

// Lights whose intensity is not above 0 are left out. Environments part from directional lights first, and both from
// the rest: each gets its share of the draws. Each leaf holds one light.
LightTree buildLightTree(std::vector<LightTreeInput> lights, std::size_t lightCount);

}  // namespace quintet::render
#endif
