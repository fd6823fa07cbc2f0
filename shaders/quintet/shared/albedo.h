// Layout of the albedo tables at Frame::albedoTables: floats, computed by src/render/albedo_tables.cpp and read by
// quintet/bsdf/albedo.glsl. Axes, both ends included: fourth roots, because the albedo of narrow lobes changes where
// the cosine is as small as alpha. cos^(1/4) from 0 to 1; alpha^(1/4) from that of kDeltaAlpha (bsdf/ggx.glsl) to 1;
// sqrt(2 (ior - 1) / (ior + 1)) from 0 to 1 (ior 3). Inside of glass the axis of the cosine has two halves that meet at
// the edge c of total reflection, a kink whatever the ior: (cos / c)^(1/4) and ((cos - c) / (1 - c))^(1/2).
#ifndef QUINTET_SHARED_ALBEDO_H
#define QUINTET_SHARED_ALBEDO_H

#include "types.h"

QT_SHARED_BEGIN

// vec2 (L, B) [roughness][cosine]: GGX with Schlick's Fresnel reflects f0 (1 - L - B) + f90 B by single scattering; L is
// lost even for f0 = f90 = 1, and tabled itself because it can be very small.
QT_CONSTANT kAlbedoCosines = 32;
QT_CONSTANT kAlbedoRoughnesses = 32;
// vec2 [roughness]: cosine-weighted averages of L and B.
QT_CONSTANT kAlbedoAverageOffset = kAlbedoCosines * kAlbedoRoughnesses * 2;
// vec2 [side][ior][roughness][cosine], side 0 outside: albedo of rough glass (reflection + refraction),
// x: with Fresnel's reflectance, y: with reflectance 0 except where reflection is total.
QT_CONSTANT kGlassCosines = 33;  // odd: one node is the edge
QT_CONSTANT kGlassRoughnesses = 16;
QT_CONSTANT kGlassIors = 12;
QT_CONSTANT kGlassOffset = kAlbedoAverageOffset + kAlbedoRoughnesses * 2;
QT_CONSTANT kAlbedoFloatCount = kGlassOffset + 2 * kGlassIors * kGlassRoughnesses * kGlassCosines * 2;

QT_SHARED_END

#endif
