// SPDX-License-Identifier: Apache-2.0
// Light sampling of emissive triangles, uniform over the world-space area. They emit on both sides.
#ifndef QUINTET_LIGHTS_TRIANGLE_GLSL
#define QUINTET_LIGHTS_TRIANGLE_GLSL

#include "../bsdf/clearcoat.glsl"
#include "../features.glsl"
#include "../sampling/warp.glsl"
#include "../shared/radiance.h"
#include "../surface.glsl"
#include "light_sample.glsl"

struct LightTriangle {
  vec3 p0, p1, p2;  // object space
  uvec3 vertices;
  vec3 normal;      // world, unit; either side
  float area;       // world, m²; 0 means degenerate
};

LightTriangle fetchLightTriangle(InstanceData instance, GeometryData geometry, uint primitive) {
  LightTriangle t;
  t.vertices = Uvec3Array(geometry.triangles).at[primitive];
  Vec3Array positions = Vec3Array(geometry.positions);
  t.p0 = positions.at[t.vertices.x];
  t.p1 = positions.at[t.vertices.y];
  t.p2 = positions.at[t.vertices.z];
  const vec3 edge1 = rowsTimesVector(instance.worldFromObject, t.p1 - t.p0);
  const vec3 edge2 = rowsTimesVector(instance.worldFromObject, t.p2 - t.p0);
  // Normalize first, because products of tiny edges would underflow.
  const float size = max(maxComponent(abs(edge1)), maxComponent(abs(edge2)));
  const vec3 n = cross(edge1 / size, edge2 / size);
  const float sine = length(n);
  t.area = sine > 0.0 ? 0.5 * sine * size * size : 0.0;
  t.normal = n / sine;
  return t;
}

float lightTexture(TextureData use, vec2 uv0, vec2 uv1, int channel) {
  return use.index == kNoTexture ? 1.0 : sampleTexture(use, use.uvSet == 0u ? uv0 : uv1)[channel];
}

// Returns the emission of a surface of this material, times its alpha coverage: any-hit shaders do not run at the end of a
// shadow ray. On an instance that is forced to be opaque they never run, so the coverage is 1. `alpha` is the vertex
// color's. `cosine` is between the light's direction and the interpolated normal; the clearcoat's normal map is ignored.
vec3 surfaceEmission(InstanceData instance, uint material, float alpha, vec2 uv0, vec2 uv1, float cosine) {
  const MaterialData m = MaterialArray(frame.materials).at[material];
  vec3 emission = m.emissive;
  if (kHasClearcoat && m.clearcoat > 0.0 && (m.flags & kMaterialUnlit) == 0u) {
    const float roughness = clamp(m.clearcoatRoughness * lightTexture(m.clearcoatRoughnessTexture, uv0, uv1, 1), 0.0, 1.0);
    const float coat = clamp(m.clearcoat * lightTexture(m.clearcoatTexture, uv0, uv1, 0), 0.0, 1.0);
    emission *= clearcoatPassed(coat, roughness * roughness, cosine);
  }
  const bool textured = (kTextureSlots & (1u << kTextureEmissive)) != 0u && m.emissiveTexture.index != kNoTexture;
  if (textured) emission *= sampleTexture(m.emissiveTexture, m.emissiveTexture.uvSet == 0u ? uv0 : uv1).rgb;
  emission = clamp(emission, 0.0, kMaxRadiance);
  if (!kHasAlpha || (m.flags & (kMaterialMask | kMaterialBlend)) == 0u) return emission;
  if ((instance.flags & kInstanceOpaque) != 0u) return emission;
  alpha *= m.baseColor.a;
  if (m.baseColorTexture.index != kNoTexture) alpha *= sampleTexture(m.baseColorTexture, m.baseColorTexture.uvSet == 0u ? uv0 : uv1).a;
  if ((m.flags & kMaterialMask) != 0u) return alpha < m.alphaCutoff ? vec3(0.0) : emission;
  return clamp(alpha, 0.0, 1.0) * emission;
}

// Returns the emission in direction -wi. `normal` is the triangle's.
vec3 lightTriangleEmission(InstanceData instance, GeometryData geometry, uvec3 v, vec3 b, vec3 wi, vec3 normal) {
  float alpha = 1.0;
  if (kHasAlpha && kHasVertexColors && geometry.colors != 0ul) {
    Vec4Array colors = Vec4Array(geometry.colors);
    alpha = dot(b, vec3(colors.at[v.x].a, colors.at[v.y].a, colors.at[v.z].a));
  }
  if (kHasClearcoat && geometry.normals != 0ul) {
    Vec3Array normals = Vec3Array(geometry.normals);
    const vec3 object = b.x * normals.at[v.x] + b.y * normals.at[v.y] + b.z * normals.at[v.z];
    normal = safeNormalize(transposeTimesVector(instance.objectFromWorld, object), normal);
  }
  const vec2 uv0 = interpolateUv(geometry, v, b, 0u);
  return surfaceEmission(instance, geometry.material, alpha, uv0, interpolateUv(geometry, v, b, 1u), abs(dot(normal, wi)));
}

// Returns the density per solid angle of a uniform point on the triangle, at distance d along a unit ray with
// cosine = |ray · normal|. Returns 0 where the density is not finite; the sampler then fails.
float pdfTriangle(float area, float d, float cosine) {
#ifdef QUINTET_WRONG_TRIANGLE_PDF
  return area > 0.0 ? d * d / area : 0.0;  // a wrong pdf without the cosine, for tests
#endif
  const float projected = area * cosine;
  const float pdf = d * d / projected;
  return projected > 0.0 && !isinf(pdf) ? pdf : 0.0;
}

bool sampleTriangleLight(LightData light, vec3 position, vec2 u, inout LightSample s) {
  const InstanceData instance = InstanceArray(frame.instances).at[light.instance];
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + light.geometry];
  const LightTriangle t = fetchLightTriangle(instance, geometry, light.primitive);
  if (!(t.area > 0.0)) return false;
  const vec2 b12 = sampleTriangle(u);
  const vec3 b = vec3(1.0 - b12.x - b12.y, b12);
  const vec3 point = rowsTimesPoint(instance.worldFromObject, b.x * t.p0 + b.y * t.p1 + b.z * t.p2);
  lightFromPoint(point, vec3(1.0), position, s);
  s.radiance = lightTriangleEmission(instance, geometry, t.vertices, b, s.wi, t.normal);
  s.pdf = pdfTriangle(t.area, s.distance, abs(dot(t.normal, s.wi)));
  s.normal = t.normal;
  s.error = surfaceError(instance, t.p0, t.p1, t.p2, point, t.normal);
  s.delta = false;
  return s.pdf > 0.0 && maxComponent(s.radiance) > 0.0;
}

#endif
