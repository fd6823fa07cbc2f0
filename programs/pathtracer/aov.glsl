// SPDX-License-Identifier: Apache-2.0
// The path tracer's outputs besides the image: properties of the first surface, and the radiance of a path classified by its
// first scattering event. Only requested outputs are compiled (QUINTET_OUTPUT_…).
#ifndef PATHTRACER_AOV_GLSL
#define PATHTRACER_AOV_GLSL

#if defined(QUINTET_OUTPUT_position) || defined(QUINTET_OUTPUT_depth) || defined(QUINTET_OUTPUT_distance) || \
    defined(QUINTET_OUTPUT_motion) || defined(QUINTET_OUTPUT_uv) || defined(QUINTET_OUTPUT_instance_id) || \
    defined(QUINTET_OUTPUT_material_id) || defined(QUINTET_OUTPUT_primitive_id)
#define AOV_CENTER
#endif
#if defined(QUINTET_OUTPUT_albedo) || defined(QUINTET_OUTPUT_normal) || defined(QUINTET_OUTPUT_cryptomatte_object) || \
    defined(QUINTET_OUTPUT_cryptomatte_material)
#define AOV_SURFACE
#endif
#if defined(QUINTET_OUTPUT_emission) || defined(QUINTET_OUTPUT_background) || defined(QUINTET_OUTPUT_direct_diffuse) || \
    defined(QUINTET_OUTPUT_indirect_diffuse) || defined(QUINTET_OUTPUT_direct_specular) || \
    defined(QUINTET_OUTPUT_indirect_specular) || defined(QUINTET_OUTPUT_direct_transmission) || \
    defined(QUINTET_OUTPUT_indirect_transmission)
#define AOV_LIGHT
#endif

// How a path found its light: kExplainFrom… (quintet/shared/explain.h).
const uint kFromBackground = 0u;
const uint kFromSurface = 1u;    // the path hit the emitter
const uint kFromShadowRay = 2u;  // from the path's last surface to a light

#ifdef AOV_SURFACE
struct FirstSurface {
  vec3 albedo;
  vec3 normal;
  uint instance;
  uint material;
  bool hit;
};
FirstSurface aovFirst;
#endif

#ifdef AOV_LIGHT
// Fractions of the first scattering event that are diffuse and specular; the rest is transmission. [0]: for the path's
// direction; [1]: for the shadow ray's.
vec3 aovDiffuse[2];
vec3 aovSpecular[2];
vec3 aovEmission, aovBackground;
vec3 aovDirect[3];  // diffuse, specular, transmission
vec3 aovIndirect[3];
#endif

// Called when a path starts.
void aovBegin() {
#ifdef AOV_SURFACE
  aovFirst = FirstSurface(vec3(0.0), vec3(0.0), 0u, 0u, false);
#endif
#ifdef AOV_LIGHT
  aovEmission = aovBackground = vec3(0.0);
  for (int i = 0; i < 3; ++i) aovDirect[i] = aovIndirect[i] = vec3(0.0);
#endif
}

// Called for the surface that a path has hit after `depth` scattering events.
void aovSurface(uint depth, HitPayload hit, Surface surface, Shading shading) {
#ifdef AOV_SURFACE
  if (depth > 0u) return;
  const vec3 albedo = shading.unlit ? min(shading.emission, vec3(1.0)) : shading.bsdf.baseColor;
  aovFirst = FirstSurface(albedo, shading.normal, hit.instance, surface.material, true);
#endif
}

// Called for a scattering event; f = bsdfEval(bsdf, wo, wi). A reflected direction is split into diffuse and specular by the
// contribution of each.
void aovScatter(uint depth, bool towardsLight, Bsdf bsdf, vec3 wi, vec3 f) {
#ifdef AOV_LIGHT
  if (depth > 0u) return;
  const vec3 diffuse = clamp(bsdfEvalDiffuse(bsdf, wi) / max(f, vec3(1e-30)), 0.0, 1.0);
  aovDiffuse[towardsLight ? 1 : 0] = wi.z > 0.0 ? diffuse : vec3(0.0);
  aovSpecular[towardsLight ? 1 : 0] = wi.z > 0.0 ? 1.0 - diffuse : vec3(0.0);
#endif
}
void aovScatterDelta(uint depth, bool transmitted) {
#ifdef AOV_LIGHT
  if (depth > 0u) return;
  aovDiffuse[0] = vec3(0.0);
  aovSpecular[0] = vec3(transmitted ? 0.0 : 1.0);
#endif
}

// Called for a scattering event in a medium, which counts as transmission.
void aovScatterMedium(uint depth) {
#ifdef AOV_LIGHT
  if (depth > 0u) return;
  for (int i = 0; i < 2; ++i) aovDiffuse[i] = aovSpecular[i] = vec3(0.0);
#endif
}

// Called for a contribution after `scatterings` events.
void aovRadiance(vec3 contribution, uint scatterings, uint source) {
#ifdef AOV_LIGHT
  if (scatterings == 0u) {
    if (source == kFromBackground) aovBackground += contribution;
    else aovEmission += contribution;
    return;
  }
  const int direction = scatterings == 1u && source == kFromShadowRay ? 1 : 0;
  const vec3 parts[3] = vec3[3](aovDiffuse[direction], aovSpecular[direction],
                                 vec3(1.0) - aovDiffuse[direction] - aovSpecular[direction]);
  for (int i = 0; i < 3; ++i) {
    if (scatterings == 1u) aovDirect[i] += parts[i] * contribution;
    else aovIndirect[i] += parts[i] * contribution;
  }
#endif
}

#define AOV_ADD(name, value) addOutput(kOutput_##name, pixel, vec4(value, 1.0));

// Called when a path has ended with a finite value. `index` is the sample's.
void aovEnd(uvec2 pixel, uint index) {
#ifdef QUINTET_OUTPUT_albedo
  AOV_ADD(albedo, aovFirst.albedo)
#endif
#ifdef QUINTET_OUTPUT_normal
  AOV_ADD(normal, aovFirst.normal)
#endif
#ifdef QUINTET_OUTPUT_emission
  AOV_ADD(emission, aovEmission)
#endif
#ifdef QUINTET_OUTPUT_background
  AOV_ADD(background, aovBackground)
#endif
#ifdef QUINTET_OUTPUT_direct_diffuse
  AOV_ADD(direct_diffuse, aovDirect[0])
#endif
#ifdef QUINTET_OUTPUT_direct_specular
  AOV_ADD(direct_specular, aovDirect[1])
#endif
#ifdef QUINTET_OUTPUT_direct_transmission
  AOV_ADD(direct_transmission, aovDirect[2])
#endif
#ifdef QUINTET_OUTPUT_indirect_diffuse
  AOV_ADD(indirect_diffuse, aovIndirect[0])
#endif
#ifdef QUINTET_OUTPUT_indirect_specular
  AOV_ADD(indirect_specular, aovIndirect[1])
#endif
#ifdef QUINTET_OUTPUT_indirect_transmission
  AOV_ADD(indirect_transmission, aovIndirect[2])
#endif
#ifdef QUINTET_OUTPUT_cryptomatte_object
  storeCoverage(kOutput_cryptomatte_object, pixel, index, aovFirst.hit ? kCoverageId + aovFirst.instance : 0u);
#endif
#ifdef QUINTET_OUTPUT_cryptomatte_material
  storeCoverage(kOutput_cryptomatte_material, pixel, index, aovFirst.hit ? kCoverageId + aovFirst.material : 0u);
#endif
}

#ifdef AOV_CENTER
const float kFarAway = 1e10;  // depth of pixels without a surface, as in other renderers

// Stores the outputs that are not averaged, for the ray through the centers of pixel and lens. Returns the number of rays.
uint aovCenter(uvec2 pixel) {
  const Ray ray = cameraRay(vec2(pixel) + 0.5, vec2(0.5));
  const HitPayload hit = traceClosest(ray.origin, ray.direction, kInfinity, hash(pixel.x | pixel.y << 16));
  const bool found = hit.t >= 0.0;
  Surface surface;
  if (found) surface = fetchSurface(hit, -ray.direction);
#ifdef QUINTET_OUTPUT_position
  storeOutput(kOutput_position, pixel, found ? vec4(surface.position, 1.0) : vec4(0.0));
#endif
#ifdef QUINTET_OUTPUT_depth
  storeOutput(kOutput_depth, pixel, found ? vec4(vec3(cameraDepth(surface.position)), 1.0) : vec4(vec3(kFarAway), 0.0));
#endif
#ifdef QUINTET_OUTPUT_distance
  storeOutput(kOutput_distance, pixel, found ? vec4(vec3(hit.t), 1.0) : vec4(vec3(kFarAway), 0.0));
#endif
#ifdef QUINTET_OUTPUT_uv
  storeOutput(kOutput_uv, pixel, found ? vec4(surface.uvs[0], 0.0, 1.0) : vec4(0.0));
#endif
#ifdef QUINTET_OUTPUT_motion
  vec2 moved = vec2(0.0);
  if (found) moved = imageMotion(hit, surface.position);
  storeOutput(kOutput_motion, pixel, found ? vec4(moved.x, -moved.y, 0.0, 1.0) : vec4(0.0));
#endif
#ifdef QUINTET_OUTPUT_instance_id
  storeOutput(kOutput_instance_id, pixel, found ? vec4(vec3(float(hit.instance) + 1.0), 1.0) : vec4(0.0));
#endif
#ifdef QUINTET_OUTPUT_material_id
  storeOutput(kOutput_material_id, pixel, found ? vec4(vec3(float(surface.material) + 1.0), 1.0) : vec4(0.0));
#endif
#ifdef QUINTET_OUTPUT_primitive_id
  storeOutput(kOutput_primitive_id, pixel, found ? vec4(vec3(float(hit.primitive) + 1.0), 1.0) : vec4(0.0));
#endif
  return 1u;
}
#else
uint aovCenter(uvec2 pixel) { return 0u; }
#endif

#endif
