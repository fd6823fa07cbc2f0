// SPDX-License-Identifier: Apache-2.0
// The tree from which lights are sampled (shared::LightNode, quintet/lights/tree.glsl). It is built top down with the
// surface area orientation heuristic of Conty Estevez and Kulla 2018, section 4.4, on all cores. The result does not
// depend on the number of cores.
#ifndef QUINTET_RENDER_LIGHTS_LIGHT_TREE_H
#define QUINTET_RENDER_LIGHTS_LIGHT_TREE_H

#include <vector>

#include "quintet/shared/frame.h"
#include "render/lights/light_bounds.h"

namespace quintet::render {

enum class LightReach : std::uint8_t { finite, directional, environment };

struct LightTreeInput {
  LightBounds bounds;
  std::uint32_t light = 0;  // index in LightTable::lights
  LightReach reach = LightReach::finite;
};

struct LightTree {
  std::vector<shared::LightNode> nodes;  // pairs of siblings begin at even indices; node 1 is unused
  std::vector<std::uint32_t> leaves;     // node of each light, or kNoLight

  // Builds a tree with one light per leaf, in the memory of an earlier tree. Lights whose intensity is not above 0 are
  // skipped. The topmost splits separate environments from directional lights, and both from finite lights; each group
  // gets its share of the samples. Changes the order of `lights`. LightTreeInput::light is below `lightCount`.
  void build(std::vector<LightTreeInput>& lights, std::size_t lightCount);
};

// Returns the quantized node of these bounds, rounded so that it contains them. The caller sets the link's index and
// leaf bit.
shared::LightNode packLightNode(const LightBounds& bounds);
// Returns the axis of a node as the device decodes it.
vec3 unpackLightAxis(std::uint32_t axis);

}  // namespace quintet::render
#endif
