// SPDX-License-Identifier: Apache-2.0
// Selection of one light, and its probability. The default is the tree of bounds (tree.glsl). QUINTET_LIGHTS_BY_POWER
// selects an alias table of the lights' powers, which the tests compare with the tree.
#ifndef QUINTET_LIGHTS_SELECTION_GLSL
#define QUINTET_LIGHTS_SELECTION_GLSL

#include "alias.glsl"
#include "tree.glsl"

// Returns the index of a light, or kNoLight. u is in [0,1); `bits` are random and independent of u.
uint chooseLight(LightSampleContext context, float u, uint bits, out float probability) {
#ifdef QUINTET_LIGHTS_BY_POWER
  uint fraction;
  const uint drawn = splitIndex(u, bits, frame.lightCount, fraction);
  return resolveAlias(AliasArray(frame.lightTable), drawn, fractionFloat(fraction), probability);
#else
  return drawLight(context, u, bits, probability);
#endif
}

// Returns the probability with which chooseLight returns `light`; 0 for kNoLight.
float lightProbability(uint light, LightSampleContext context) {
  if (light == kNoLight) return 0.0;
#ifdef QUINTET_LIGHTS_BY_POWER
  return AliasArray(frame.lightTable).at[light].probability;
#else
  return lightLeafProbability(context, LightArray(frame.lights).at[light].leaf);
#endif
}

#endif
