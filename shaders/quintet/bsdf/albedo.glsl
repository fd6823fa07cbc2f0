// Directional albedos from the tables at Frame::albedoTables (shared/albedo.h has their layout), for
// compensating the energy that single scattering loses and for coupling layers.
#ifndef QUINTET_BSDF_ALBEDO_GLSL
#define QUINTET_BSDF_ALBEDO_GLSL

#include "../frame.glsl"
#include "../shared/albedo.h"

// A cell of a table axis: the index of its first node and the position in it, [0,1].
struct AlbedoCell {
  uint index;
  float offset;
};

AlbedoCell albedoCell(float position, uint nodeCount) {
  float x = clamp(position, 0.0, 1.0) * float(nodeCount - 1u);
  uint index = min(uint(x), nodeCount - 2u);
  return AlbedoCell(index, x - float(index));
}

// Bilinear value of the vec2 table with `columns` cosines that starts at `table`.
vec2 albedoFetch(Address table, uint columns, AlbedoCell row, AlbedoCell column) {
  Vec2Array values = Vec2Array(table);
  uint i = row.index * columns + column.index;
  uint j = i + columns;
  return mix(mix(values.at[i], values.at[i + 1u], column.offset),
             mix(values.at[j], values.at[j + 1u], column.offset), row.offset);
}

AlbedoCell albedoRow(float alpha) { return albedoCell(sqrt(alpha), kAlbedoRoughnesses); }

// (A, B): single scattering by GGX with Schlick's Fresnel reflects f0 A + f90 B of a parallel light.
vec2 albedoSchlick(AlbedoCell row, float cosine) {
  return albedoFetch(frame.albedoTables, kAlbedoCosines, row, albedoCell(sqrt(max(cosine, 0.0)), kAlbedoCosines));
}

// The factor that puts the energy of multiple scattering back: the light that single scattering loses
// meets the surface again, where f0 of it is reflected. 1 / (A + B) for f0 = 1: nothing is lost.
// Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 16.
vec3 albedoGain(vec3 f0, vec2 ab) { return 1.0 + f0 * (1.0 / max(ab.x + ab.y, 1e-3) - 1.0); }
// The albedo with it.
float albedoCompensated(float f0, float f90, vec2 ab) { return (f0 * ab.x + f90 * ab.y) * albedoGain(vec3(f0), ab).x; }

// Cosine-weighted average over the hemisphere of albedoCompensated (a polynomial in f0 and f90).
float albedoAverage(float f0, float f90, AlbedoCell row) {
  Vec4Array values = Vec4Array(frame.albedoTables + 4u * kAlbedoAverageOffset);
  vec4 average = mix(values.at[row.index], values.at[row.index + 1u], row.offset);
  return dot(average, vec4(f0, f90, f0 * f0, f0 * f90));
}

// Albedo of rough glass under single scattering: x with Fresnel's reflectance, y with none but total
// reflection. `ior` is the material's; outside: the light's side is not the material's.
vec2 albedoGlass(float cosine, float alpha, float ior, bool outside) {
  AlbedoCell row = albedoCell(sqrt(alpha), kGlassRoughnesses);
  AlbedoCell column = albedoCell(sqrt(max(cosine, 0.0)), kGlassCosines);
  AlbedoCell layer = albedoCell(sqrt(2.0 * (ior - 1.0) / (ior + 1.0)), kGlassIors);
  uint stride = 8u * kGlassRoughnesses * kGlassCosines;
  Address table = frame.albedoTables + 4u * kGlassOffset + stride * (layer.index + (outside ? 0u : kGlassIors));
  return mix(albedoFetch(table, kGlassCosines, row, column), albedoFetch(table + stride, kGlassCosines, row, column), layer.offset);
}

#endif
