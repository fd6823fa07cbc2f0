// SPDX-License-Identifier: Apache-2.0
// Point light of KHR_lights_punctual: the same radiant intensity in all directions, inverse square law. The property
// `range` is a hint for rasterization and has no effect.
#ifndef QUINTET_LIGHTS_POINT_GLSL
#define QUINTET_LIGHTS_POINT_GLSL

#include "light_sample.glsl"

bool samplePointLight(LightData light, vec3 position, inout LightSample s) {
  return lightFromPoint(light.position, light.intensity, position, s);
}

#endif
