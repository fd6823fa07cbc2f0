// SPDX-License-Identifier: Apache-2.0
// Directional light of KHR_lights_punctual: parallel rays from infinity. The intensity is the irradiance of a surface that
// faces the light.
#ifndef QUINTET_LIGHTS_DIRECTIONAL_GLSL
#define QUINTET_LIGHTS_DIRECTIONAL_GLSL

#include "light_sample.glsl"

bool sampleDirectionalLight(LightData light, inout LightSample s) {
  lightFromInfinity(-light.direction, light.intensity, true, s);
  return maxComponent(light.intensity) > 0.0;
}

#endif
