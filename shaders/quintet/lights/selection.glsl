// The choice of one light, and its probability: by the tree of bounds (tree.glsl), or with QUINTET_LIGHTS_BY_POWER by
// one alias table of powers for all receivers, which tests compare with it.
#ifndef QUINTET_LIGHTS_SELECTION_GLSL
#define QUINTET_LIGHTS_SELECTION_GLSL

#include "alias.glsl"
#include "tree.glsl"

// Index of a light by u in [0,1), or kNoLight; `bits`: random, independent of u.
uint chooseLight(LightReceiver receiver, float u, uint bits, out float probability) {
#ifdef QUINTET_LIGHTS_BY_POWER
  uint fraction;
  const uint drawn = splitIndex(u, bits, frame.lightCount, fraction);
  return resolveAlias(AliasArray(frame.lightTable), drawn, fractionFloat(fraction), probability);
#else
  return drawLight(receiver, u, bits, probability);
#endif
}

// The probability with which chooseLight returns `light`; 0 for kNoLight.
float lightProbability(uint light, LightReceiver receiver) {
  if (light == kNoLight) return 0.0;
#ifdef QUINTET_LIGHTS_BY_POWER
  return AliasArray(frame.lightTable).at[light].probability;
#else
  return lightLeafProbability(receiver, LightArray(frame.lights).at[light].leaf);
#endif
}

#endif
