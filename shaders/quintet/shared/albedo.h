// SPDX-License-Identifier: Apache-2.0
// Layout of the albedo tables at Frame::albedoTables: floats, computed by src/render/scene/albedo_tables.cpp and read by
// quintet/bsdf/albedo.glsl. All axes include both ends:
// - cosine: cos^(1/4) from 0 to 1. The albedo of narrow lobes changes where the cosine is as small as alpha.
// - roughness: alpha^(1/4), from kDeltaAlpha (bsdf/ggx.glsl) to 1
// - ior: sqrt(2 (ior - 1) / (ior + 1)) from 0 to 1 (ior 3)
// Inside glass the cosine axis has two halves: (cos / c)^(1/4) and ((cos - c) / (1 - c))^(1/2). They join at the cosine c
// where total reflection begins, because the albedo has a kink there.
#ifndef QUINTET_SHARED_ALBEDO_H
#define QUINTET_SHARED_ALBEDO_H

#include "types.h"

QT_SHARED_BEGIN

// vec2 (L, B) [roughness][cosine]: the albedo of single scattering by GGX with Schlick's Fresnel is f0 (1 - L - B) + f90 B.
// L is the loss for f0 = f90 = 1. The table stores L itself, because it can be very small.
QT_CONSTANT kAlbedoCosines = 32;
QT_CONSTANT kAlbedoRoughnesses = 32;
// vec2 [roughness]: cosine-weighted averages of L and B.
QT_CONSTANT kAlbedoAverageOffset = kAlbedoCosines * kAlbedoRoughnesses * 2;
// vec2 [side][ior][roughness][cosine], side 0 is outside: albedo of rough glass (reflection and refraction).
// x: with Fresnel's reflectance; y: with reflectance 0, except for total reflection.
QT_CONSTANT kGlassCosines = 33;  // odd, so that one node is at c
QT_CONSTANT kGlassRoughnesses = 16;
QT_CONSTANT kGlassIors = 12;
QT_CONSTANT kGlassOffset = kAlbedoAverageOffset + kAlbedoRoughnesses * 2;
// vec2 (E, A) [roughness][cosine], with kAlbedoCosines cosines: the albedo of the sheen lobe before and after it is limited
// (bsdf/sheen.glsl).
QT_CONSTANT kSheenRoughnesses = 24;
QT_CONSTANT kSheenOffset = kGlassOffset + 2 * kGlassIors * kGlassRoughnesses * kGlassCosines * 2;
// vec2 [roughness]: cosine-weighted average of A; 0.
QT_CONSTANT kSheenAverageOffset = kSheenOffset + kSheenRoughnesses * kAlbedoCosines * 2;
// vec2 [roughness of the sheen][roughness of the base]: cosine-weighted averages of A L and A B.
QT_CONSTANT kSheenBaseOffset = kSheenAverageOffset + kSheenRoughnesses * 2;
// vec2 (L, B) [alpha y][ratio][cosine][width] of an anisotropic surface, with the larger alpha along x:
// - ratio: (alpha_x^(1/4) - alpha_y^(1/4)) / (1 - alpha_y^(1/4)) from 0 to 1
// - width w along the azimuth of the direction: (w^(1/4) - alpha_y^(1/4)) / (alpha_x^(1/4) - alpha_y^(1/4)) from 0 to 1
QT_CONSTANT kAnisotropyRoughnesses = 8;
QT_CONSTANT kAnisotropyRatios = 6;
QT_CONSTANT kAnisotropyCosines = 20;
QT_CONSTANT kAnisotropyWidths = 8;
QT_CONSTANT kAnisotropyOffset = kSheenBaseOffset + kSheenRoughnesses * kAlbedoRoughnesses * 2;
// vec2 [alpha y][ratio]: cosine-weighted averages of L and B.
QT_CONSTANT kAnisotropyAverageOffset = kAnisotropyOffset + kAnisotropyRoughnesses * kAnisotropyRatios * kAnisotropyCosines * kAnisotropyWidths * 2;
// float [roughness][cosine][node], with kAlbedoCosines cosines: the albedo of single scattering by GGX with the reflectance
// hat_k(sqrt(cos)), which is 1 at node k and goes linearly to 0 at the nodes beside it. Node k is at sqrt(cos) =
// k / (kFilmNodes - 1). The sum over the nodes is 1 - L.
QT_CONSTANT kFilmNodes = 8;
QT_CONSTANT kFilmRoughnesses = 16;
QT_CONSTANT kFilmOffset = kAnisotropyAverageOffset + kAnisotropyRoughnesses * kAnisotropyRatios * 2;
// float [roughness][node]: cosine-weighted averages.
QT_CONSTANT kFilmAverageOffset = kFilmOffset + kFilmRoughnesses * kAlbedoCosines * kFilmNodes;
QT_CONSTANT kAlbedoFloatCount = kFilmAverageOffset + kFilmRoughnesses * kFilmNodes;

QT_SHARED_END

#endif
