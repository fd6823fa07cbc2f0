// SPDX-License-Identifier: Apache-2.0
// Directional albedos from the tables at Frame::albedoTables (layout: shared/albedo.h). They compensate for the energy that
// single scattering loses, and they couple layers.
#ifndef QUINTET_BSDF_ALBEDO_GLSL
#define QUINTET_BSDF_ALBEDO_GLSL

#include "anisotropy.glsl"
#include "../shared/albedo.h"

// A cell of a table axis: the index of its first node, and the position in the cell, [0,1].
struct AlbedoCell {
  uint index;
  float offset;
};

AlbedoCell albedoCell(float position, uint nodeCount) {
  float x = clamp(position, 0.0, 1.0) * float(nodeCount - 1u);
  uint index = min(uint(x), nodeCount - 2u);
  return AlbedoCell(index, x - float(index));
}

// Returns the bilinearly interpolated value of the vec2 table at `table` with `columns` cosines.
vec2 albedoFetch(Address table, uint columns, AlbedoCell row, AlbedoCell column) {
  Vec2Array values = Vec2Array(table);
  uint i = row.index * columns + column.index;
  uint j = i + columns;
  return mix(mix(values.at[i], values.at[i + 1u], column.offset),
             mix(values.at[j], values.at[j + 1u], column.offset), row.offset);
}

// Coordinate of an axis of cos^(1/4) or alpha^(1/4).
float albedoRoot(float x) { return sqrt(sqrt(max(x, 0.0))); }
AlbedoCell albedoRow(float alpha, uint nodeCount) {
  float first = albedoRoot(kDeltaAlpha);
  return albedoCell((albedoRoot(alpha) - first) / (1.0 - first), nodeCount);
}
AlbedoCell albedoRow(float alpha) { return albedoRow(alpha, kAlbedoRoughnesses); }

// Returns (L, B). The albedo of single scattering by GGX with Schlick's Fresnel is f0 (1 - L - B) + f90 B; L is the loss
// for f0 = f90 = 1.
vec2 albedoSchlick(AlbedoCell row, float cosine) {
  return albedoFetch(frame.albedoTables, kAlbedoCosines, row, albedoCell(albedoRoot(cosine), kAlbedoCosines));
}

vec3 albedoSingle(vec3 f0, float f90, vec2 lb) { return f0 * (1.0 - lb.x - lb.y) + f90 * lb.y; }

// Returns the cosine-weighted averages of L and B over the hemisphere.
vec2 albedoAverage(AlbedoCell row) {
  Vec2Array values = Vec2Array(frame.albedoTables + 4u * kAlbedoAverageOffset);
  return mix(values.at[row.index], values.at[row.index + 1u], row.offset);
}

// The position of the base's widths in the tables.
struct AlbedoRoughness {
  AlbedoCell row;      // of one width: the only one, or the mean width
  vec2 alpha;
  AlbedoCell across;   // of the anisotropic table: alpha.y
  AlbedoCell ratio;    // alpha.x / alpha.y
  bool anisotropic;    // the widths differ by more than rounding
};

AlbedoRoughness albedoRoughness(vec2 alpha) {
  AlbedoRoughness r;
  r.row = albedoRow(ggxMeanWidth(alpha));
  r.alpha = alpha;
  r.anisotropic = kHasAnisotropy && alpha.x > 1.0001 * alpha.y;
  float small = albedoRoot(alpha.y);
  r.across = albedoRow(alpha.y, kAnisotropyRoughnesses);
  r.ratio = albedoCell((albedoRoot(alpha.x) - small) / max(1.0 - small, 1e-6), kAnisotropyRatios);
  return r;
}

// Returns the value of an anisotropic surface at the row and ratio `node`, interpolated in cosine and width.
vec2 albedoAnisotropicNode(uint node, AlbedoCell cosine, AlbedoCell width) {
  Address table = frame.albedoTables + 4u * kAnisotropyOffset + 8u * kAnisotropyCosines * kAnisotropyWidths * node;
  return albedoFetch(table, kAnisotropyWidths, cosine, width);
}

// Returns (L, B) for the direction w, with w.z >= 0.
vec2 albedoSchlick(AlbedoRoughness r, vec3 w) {
  if (!r.anisotropic) return albedoSchlick(r.row, w.z);
  // The width along the azimuth of w, which decides the masking of w.
  float length2 = dot(w.xy, w.xy);
  float width = length2 > 0.0 ? sqrt(dot(r.alpha * w.xy, r.alpha * w.xy) / length2) : r.alpha.y;
  float low = albedoRoot(r.alpha.y);
  AlbedoCell along = albedoCell((albedoRoot(width) - low) / (albedoRoot(r.alpha.x) - low), kAnisotropyWidths);
  AlbedoCell cosine = albedoCell(albedoRoot(w.z), kAnisotropyCosines);
  vec2 value = vec2(0.0);
  for (uint corner = 0u; corner < 4u; ++corner) {
    uint i = corner >> 1u, j = corner & 1u;
    float weight = (i == 1u ? r.across.offset : 1.0 - r.across.offset) * (j == 1u ? r.ratio.offset : 1.0 - r.ratio.offset);
    value += weight * albedoAnisotropicNode((r.across.index + i) * kAnisotropyRatios + r.ratio.index + j, cosine, along);
  }
  return value;
}

// Returns the cosine-weighted averages of L and B over the hemisphere.
vec2 albedoAverage(AlbedoRoughness r) {
  if (!r.anisotropic) return albedoAverage(r.row);
  return albedoFetch(frame.albedoTables + 4u * kAnisotropyAverageOffset, kAnisotropyRatios, r.across, r.ratio);
}

// Reflectance that a thin film adds to Schlick's at the nodes of the film tables (shared/albedo.h): the first and the last
// four nodes. It can be negative.
struct AlbedoFilm {
  vec4 low;
  vec4 high;
};

float albedoFilmAt(AlbedoFilm film, Address nodes) {
  Vec4Array values = Vec4Array(nodes);
  return dot(film.low, values.at[0]) + dot(film.high, values.at[1]);
}

// Returns the albedo of single scattering that the film adds, in a row of the tables.
float albedoFilmRow(AlbedoFilm film, uint row, AlbedoCell column) {
  Address nodes = frame.albedoTables + 4u * kFilmOffset + 4u * kFilmNodes * (row * kAlbedoCosines + column.index);
  return mix(albedoFilmAt(film, nodes), albedoFilmAt(film, nodes + 4u * kFilmNodes), column.offset);
}

float albedoFilm(AlbedoFilm film, float alpha, float cosine) {
  AlbedoCell row = albedoRow(alpha, kFilmRoughnesses);
  AlbedoCell column = albedoCell(albedoRoot(cosine), kAlbedoCosines);
  return mix(albedoFilmRow(film, row.index, column), albedoFilmRow(film, row.index + 1u, column), row.offset);
}

// Returns the cosine-weighted average over the hemisphere of the albedo that the film adds.
float albedoFilmAverage(AlbedoFilm film, float alpha) {
  AlbedoCell row = albedoRow(alpha, kFilmRoughnesses);
  Address nodes = frame.albedoTables + 4u * kFilmAverageOffset + 4u * kFilmNodes * row.index;
  return mix(albedoFilmAt(film, nodes), albedoFilmAt(film, nodes + 4u * kFilmNodes), row.offset);
}

// Returns the albedo of rough glass with single scattering: x with Fresnel's reflectance, y with total reflection only.
// `ior` is the material's. `outside`: wo is outside the solid.
vec2 albedoGlass(float cosine, float alpha, float ior, bool outside) {
  float edge = outside ? 1.0 : sqrt(max(1.0 - 1.0 / (ior * ior), 1e-6));
  float inner = cosine < edge ? 0.5 * albedoRoot(cosine / edge) : 0.5 + 0.5 * sqrt((cosine - edge) / max(1.0 - edge, 1e-6));
  AlbedoCell row = albedoRow(alpha, kGlassRoughnesses);
  AlbedoCell column = albedoCell(outside ? albedoRoot(cosine) : inner, kGlassCosines);
  AlbedoCell layer = albedoCell(sqrt(2.0 * (ior - 1.0) / (ior + 1.0)), kGlassIors);
  uint stride = 8u * kGlassRoughnesses * kGlassCosines;
  Address table = frame.albedoTables + 4u * kGlassOffset + stride * (layer.index + (outside ? 0u : kGlassIors));
  return mix(albedoFetch(table, kGlassCosines, row, column), albedoFetch(table + stride, kGlassCosines, row, column), layer.offset);
}

// Returns (E, A) of the sheen lobe at `cosine`; bsdf/sheen.glsl defines them. `row`: albedoRow(alpha, kSheenRoughnesses).
vec2 albedoSheen(AlbedoCell row, float cosine) {
  return albedoFetch(frame.albedoTables + 4u * kSheenOffset, kAlbedoCosines, row, albedoCell(albedoRoot(cosine), kAlbedoCosines));
}

// Returns the cosine-weighted averages over the hemisphere of A, A L and A B. L and B are those of albedoSchlick for the
// base's roughness `base`.
vec3 albedoSheenAverages(AlbedoCell row, AlbedoCell base) {
  Vec2Array values = Vec2Array(frame.albedoTables + 4u * kSheenAverageOffset);
  float average = mix(values.at[row.index].x, values.at[row.index + 1u].x, row.offset);
  return vec3(average, albedoFetch(frame.albedoTables + 4u * kSheenBaseOffset, kAlbedoRoughnesses, row, base));
}

#endif
