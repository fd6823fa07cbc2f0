// Layout of the albedo tables at Frame::albedoTables: floats, computed by src/render/albedo_tables.cpp and read by
// quintet/bsdf/albedo.glsl. Axes are uniform in sqrt(cos theta), in roughness = sqrt(alpha) and in
// sqrt(2 (ior - 1) / (ior + 1)); they go from 0 to 1 (ior 3), both ends included.
#ifndef QUINTET_SHARED_ALBEDO_H
#define QUINTET_SHARED_ALBEDO_H

#include "types.h"

QT_SHARED_BEGIN

// vec2 (A, B) [roughness][cosine]: albedo of GGX reflection with Schlick's Fresnel is f0 A + f90 B.
QT_CONSTANT kAlbedoCosines = 32;
QT_CONSTANT kAlbedoRoughnesses = 32;
// vec4 [roughness]: cosine-weighted averages of A, B, A(1-E)/E and B(1-E)/E, with E = A + B.
QT_CONSTANT kAlbedoAverageOffset = kAlbedoCosines * kAlbedoRoughnesses * 2;
// vec2 [side][ior][roughness][cosine], side 0 outside: albedo of rough glass (reflection + refraction),
// x: with Fresnel's reflectance, y: with reflectance 0 except where reflection is total.
QT_CONSTANT kGlassCosines = 24;
QT_CONSTANT kGlassRoughnesses = 14;
QT_CONSTANT kGlassIors = 12;
QT_CONSTANT kGlassOffset = kAlbedoAverageOffset + kAlbedoRoughnesses * 4;
QT_CONSTANT kAlbedoFloatCount = kGlassOffset + 2 * kGlassIors * kGlassRoughnesses * kGlassCosines * 2;

QT_SHARED_END

#endif
