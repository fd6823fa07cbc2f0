// All lights of the scene behind one door. One alias table chooses a light (its probabilities: src/render/
// light_table.h); each type is sampled by its own file. A sampler returns false when the drawn
// light gives nothing at `position`; that outcome counts as an estimate of 0.
#ifndef QUINTET_LIGHTS_LIGHTS_GLSL
#define QUINTET_LIGHTS_LIGHTS_GLSL

#include "../features.glsl"
#include "alias.glsl"
#include "directional.glsl"
#include "environment.glsl"
#include "point.glsl"
#include "solid.glsl"
#include "spot.glsl"
#include "triangle.glsl"

// uLight chooses the light, u the point on it, each in [0,1). Estimator: f · radiance / pdf.
bool sampleLight(vec3 position, float uLight, vec2 u, out LightSample s) {
  if (frame.lightCount == 0u) return false;
  // Digits beyond the 24 of uLight and u: a hash of all three, so unrelated to each of them.
  const uint bits = hashCombine(hashCombine(floatBitsToUint(uLight), floatBitsToUint(u.x)), floatBitsToUint(u.y));
  uint fraction;
  float probability;
  const uint drawn = splitIndex(uLight, bits, frame.lightCount, fraction);
  const uint index = resolveAlias(AliasArray(frame.lightTable), drawn, fractionFloat(fraction), probability);
  const LightData light = LightArray(frame.lights).at[index];

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

// Density with which sampleLight finds the point of an emissive triangle that a BSDF-sampled ray has met at
// `distance` (unit direction) with |direction · normal| = cosine; 0 if the triangle is not in the table.
float pdfLightTriangle(uint instanceIndex, uint geometryIndex, uint primitive, float distance, float cosine) {
  if (!kHasTriangleLights) return 0.0;
  const InstanceData instance = InstanceArray(frame.instances).at[instanceIndex];
  const uint slot = UintArray(frame.lightSlots).at[instance.firstLightSlot + geometryIndex];
  if (slot == kNoLight) return 0.0;
  const float probability = AliasArray(frame.lightTable).at[slot + primitive].probability;
  if (probability == 0.0) return 0.0;
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + geometryIndex];
  return probability * pdfTriangle(fetchLightTriangle(instance, geometry, primitive).area, distance, cosine);
}

// The same for any surface that a ray from `origin` has met after `distance`: triangle or solid.
float pdfLightHit(HitPayload hit, vec3 origin, float distance, float cosine) {
#ifndef QUINTET_NO_PROCEDURALS
  const InstanceData instance = InstanceArray(frame.instances).at[hit.instance];
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + hit.geometry];
  if (geometry.kind != kGeometryTriangles) {
    if (!kHasSolidLights) return 0.0;
    const uint slot = UintArray(frame.lightSlots).at[instance.firstLightSlot + hit.geometry];
    if (slot == kNoLight) return 0.0;
    const float probability = AliasArray(frame.lightTable).at[slot + hit.primitive].probability;
    const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[hit.primitive];
    const uint face = (hit.part >> kPartFaceShift) & 7u;
    return probability > 0.0 ? probability * pdfSolid(instance, primitive, face, hit.barycentric, origin, distance, cosine) : 0.0;
  }
#endif
  return pdfLightTriangle(hit.instance, hit.geometry, hit.primitive, distance, cosine);
}

// Density with which sampleLight finds the direction of a BSDF-sampled ray that has left the scene.
float pdfLightEnvironment(vec3 direction) {
  if (!kHasEnvironment || frame.environmentLight == kNoLight) return 0.0;
  return AliasArray(frame.lightTable).at[frame.environmentLight].probability * environmentPdf(direction);
}

#endif
