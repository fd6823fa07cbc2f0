// SPDX-License-Identifier: Apache-2.0
// Sampling of all lights of the scene. selection.glsl chooses a light; each type of light has its own file. A sampler
// returns false if the chosen light does not contribute; the estimate is then 0.
#ifndef QUINTET_LIGHTS_LIGHTS_GLSL
#define QUINTET_LIGHTS_LIGHTS_GLSL

#include "../explain_hooks.glsl"
#include "../features.glsl"
#include "directional.glsl"
#include "environment.glsl"
#include "point.glsl"
#include "selection.glsl"
#include "solid.glsl"
#include "spot.glsl"
#include "triangle.glsl"

// uLight chooses the light, u the point on it; both in [0,1). Estimator: f · radiance / pdf.
bool sampleLight(LightSampleContext context, float uLight, vec2 u, out LightSample s) {
  if (frame.lightCount == 0u) return false;
  // Bits beyond the 24 of uLight and u: a hash of all three numbers, so uncorrelated with each of them.
  const uint bits = hashCombine(hashCombine(floatBitsToUint(uLight), floatBitsToUint(u.x)), floatBitsToUint(u.y));
  float probability;
  const uint index = chooseLight(context, uLight, bits, probability);
  explainLightChoice(index, probability);
  if (index == kNoLight) return false;
  const LightData light = LightArray(frame.lights).at[index];
  const vec3 position = context.position;

  bool useful = false;
  if (kHasTriangleLights && light.type == kLightTriangle) useful = sampleTriangleLight(light, position, u, s);
  else if (kHasEnvironment && light.type == kLightEnvironment) useful = sampleEnvironmentLight(u, hash(bits), s);
  else if (kHasPunctualLights && light.type == kLightPoint) useful = samplePointLight(light, position, s);
  else if (kHasPunctualLights && light.type == kLightSpot) useful = sampleSpotLight(light, position, s);
  else if (kHasPunctualLights && light.type == kLightDirectional) useful = sampleDirectionalLight(light, s);
#ifndef QUINTET_NO_PROCEDURALS
  else if (kHasSolidLights && light.type == kLightSolid) useful = sampleSolidLight(light, position, u, s);
#endif
  s.pdf *= probability;
  return useful && s.pdf > 0.0;
}

// For a point without a surface.
bool sampleLight(vec3 position, float uLight, vec2 u, out LightSample s) {
  return sampleLight(lightSampleContext(position), uLight, u, s);
}

// Returns the index of the light that a ray has hit: the environment if the ray has left the scene (hit.t < 0), kNoLight
// if light sampling cannot find the surface.
uint lightOfHit(HitPayload hit) {
  if (hit.t < 0.0) return kHasEnvironment ? frame.environmentLight : kNoLight;
  if (!kHasTriangleLights && !kHasSolidLights) return kNoLight;
  const InstanceData instance = InstanceArray(frame.instances).at[hit.instance];
  const uint slot = UintArray(frame.lightSlots).at[instance.firstLightSlot + hit.geometry];
  return slot == kNoLight ? kNoLight : slot + hit.primitive;
}

// Returns the density per solid angle at `position` with which sampling the light that was hit finds the point of the hit,
// at `distance` along a unit ray with cosine = |ray · normal|.
float pdfLightPoint(HitPayload hit, vec3 position, float distance, float cosine) {
  const InstanceData instance = InstanceArray(frame.instances).at[hit.instance];
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + hit.geometry];
#ifndef QUINTET_NO_PROCEDURALS
  if (geometry.kind != kGeometryTriangles) {
    if (!kHasSolidLights) return 0.0;
    const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[hit.primitive];
    const bool front = (hit.part & kPartFront) != 0u;
    return pdfSolid(instance, primitive, (hit.part >> kPartFaceShift) & 7u, hit.barycentric, front, position, distance, cosine);
  }
#endif
  return kHasTriangleLights ? pdfTriangle(fetchLightTriangle(instance, geometry, hit.primitive).area, distance, cosine) : 0.0;
}

// Returns the density with which sampleLight finds the surface point that a BSDF-sampled ray has hit.
float pdfLightHit(HitPayload hit, LightSampleContext context, float distance, float cosine) {
  const float probability = lightProbability(lightOfHit(hit), context);
  return probability > 0.0 ? probability * pdfLightPoint(hit, context.position, distance, cosine) : 0.0;
}

// Returns the density with which sampleLight finds the direction of a BSDF-sampled ray that has left the scene.
float pdfLightEnvironment(vec3 direction, LightSampleContext context) {
  if (!kHasEnvironment || frame.environmentLight == kNoLight) return 0.0;
  return lightProbability(frame.environmentLight, context) * environmentPdf(direction);
}

#endif
