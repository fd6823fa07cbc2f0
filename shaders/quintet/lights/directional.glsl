// Directional light of KHR_lights_punctual: parallel rays, infinitely far; its intensity is the irradiance of
// a surface that faces it.
#ifndef QUINTET_LIGHTS_DIRECTIONAL_GLSL
#define QUINTET_LIGHTS_DIRECTIONAL_GLSL

#include "light_sample.glsl"

bool sampleDirectionalLight(LightData light, inout LightSample s) {
  lightFromInfinity(-light.direction, light.intensity, true, s);
  return maxComponent(light.intensity) > 0.0;
}

#endif
