// SPDX-License-Identifier: Apache-2.0
// Spot light of KHR_lights_punctual: a point light with a smooth cone. It has full intensity within the inner angle and
// none outside the outer angle and beyond the range.
#ifndef QUINTET_LIGHTS_SPOT_GLSL
#define QUINTET_LIGHTS_SPOT_GLSL

#include "light_sample.glsl"

// Angular attenuation of the extension: ((cos - cosOuter) / max(0.001, cosInner - cosOuter)) clamped, squared.
float spotAttenuation(LightData light, float cosine) {
  const float a = clamp((cosine - light.cosOuter) / max(0.001, light.cosInner - light.cosOuter), 0.0, 1.0);
  return a * a;
}

bool sampleSpotLight(LightData light, vec3 position, inout LightSample s) {
  const vec3 d = position - light.position;
  const float attenuation = spotAttenuation(light, dot(light.direction, normalize(d))) *
                            rangeAttenuation(length(d), uintBitsToFloat(light.geometry));
  return lightFromPoint(light.position, light.intensity * attenuation, position, s);
}

#endif
