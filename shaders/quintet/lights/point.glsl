// SPDX-License-Identifier: Apache-2.0
// Point light of KHR_lights_punctual: the same radiant intensity in all directions, inverse square law, attenuation by the
// range.
#ifndef QUINTET_LIGHTS_POINT_GLSL
#define QUINTET_LIGHTS_POINT_GLSL

#include "light_sample.glsl"

bool samplePointLight(LightData light, vec3 position, inout LightSample s) {
  const float attenuation = rangeAttenuation(distance(light.position, position), uintBitsToFloat(light.geometry));
  return lightFromPoint(light.position, light.intensity * attenuation, position, s);
}

#endif
