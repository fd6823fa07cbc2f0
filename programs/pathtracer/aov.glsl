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
// Fractions of a scattering event that are diffuse and specular; the rest is transmission.
struct ScatteringFractions {
  vec3 diffuse;
  vec3 specular;
};
struct ScatteredLight {
  vec3 diffuse;
  vec3 specular;
  vec3 transmission;
};
// Structures instead of arrays, because of a defect of NVIDIA's driver (docs/design/quirks.md).
ScatteringFractions aovPath;       // of the first scattering event, for the path's direction
ScatteringFractions aovShadowRay;  // the same for the shadow ray's
ScatteredLight aovDirect;
ScatteredLight aovIndirect;
vec3 aovEmission, aovBackground;
#endif

// Called when a path starts.
void aovBegin() {
#ifdef AOV_SURFACE
  aovFirst = FirstSurface(vec3(0.0), vec3(0.0), 0u, 0u, false);
#endif
#ifdef AOV_LIGHT
  aovEmission = aovBackground = vec3(0.0);
  aovDirect = aovIndirect = ScatteredLight(vec3(0.0), vec3(0.0), vec3(0.0));
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
  ScatteringFractions fractions = ScatteringFractions(vec3(0.0), vec3(0.0));
  if (wi.z > 0.0) fractions = ScatteringFractions(diffuse, 1.0 - diffuse);
  if (towardsLight) aovShadowRay = fractions;
  else aovPath = fractions;
#endif
}
void aovScatterDelta(uint depth, bool transmitted) {
#ifdef AOV_LIGHT
  if (depth > 0u) return;
  aovPath = ScatteringFractions(vec3(0.0), vec3(transmitted ? 0.0 : 1.0));
#endif
}

// Called for a scattering event in a medium, which counts as transmission.
void aovScatterMedium(uint depth) {
#ifdef AOV_LIGHT
  if (depth > 0u) return;
  aovPath = aovShadowRay = ScatteringFractions(vec3(0.0), vec3(0.0));
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
  ScatteringFractions fractions = aovPath;
  if (scatterings == 1u && source == kFromShadowRay) fractions = aovShadowRay;
  const vec3 diffuse = fractions.diffuse * contribution;
  const vec3 specular = fractions.specular * contribution;
  const vec3 transmission = (vec3(1.0) - fractions.diffuse - fractions.specular) * contribution;
  if (scatterings == 1u) {
    aovDirect.diffuse += diffuse;
    aovDirect.specular += specular;
    aovDirect.transmission += transmission;
  } else {
    aovIndirect.diffuse += diffuse;
    aovIndirect.specular += specular;
    aovIndirect.transmission += transmission;
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
  AOV_ADD(direct_diffuse, aovDirect.diffuse)
#endif
#ifdef QUINTET_OUTPUT_direct_specular
  AOV_ADD(direct_specular, aovDirect.specular)
#endif
#ifdef QUINTET_OUTPUT_direct_transmission
  AOV_ADD(direct_transmission, aovDirect.transmission)
#endif
#ifdef QUINTET_OUTPUT_indirect_diffuse
  AOV_ADD(indirect_diffuse, aovIndirect.diffuse)
#endif
#ifdef QUINTET_OUTPUT_indirect_specular
  AOV_ADD(indirect_specular, aovIndirect.specular)
#endif
#ifdef QUINTET_OUTPUT_indirect_transmission
  AOV_ADD(indirect_transmission, aovIndirect.transmission)
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
