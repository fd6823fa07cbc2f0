// Point light of KHR_lights_punctual: the same radiant intensity in all directions, inverse square law. The file's
// `range` is a hint for rasterisers and has no effect.
#ifndef QUINTET_LIGHTS_POINT_GLSL
#define QUINTET_LIGHTS_POINT_GLSL

#include "light_sample.glsl"

bool samplePointLight(LightData light, vec3 position, inout LightSample s) {
  return lightFromPoint(light.position, light.intensity, position, s);
}

#endif
