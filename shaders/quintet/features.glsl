// What the scene has. The renderer defines QUINTET_NO_… for what no material and no light of the scene
// needs (src/render/scene_features.h); the compiler then drops that code. Results do not change.
#ifndef QUINTET_FEATURES_GLSL
#define QUINTET_FEATURES_GLSL

#ifdef QUINTET_NO_SOLID_TRANSMISSION
const bool kHasSolidTransmission = false;  // refraction into closed solids
#else
const bool kHasSolidTransmission = true;
#endif
#ifdef QUINTET_NO_THIN_TRANSMISSION
const bool kHasThinTransmission = false;  // thin walls
#else
const bool kHasThinTransmission = true;
#endif
#ifdef QUINTET_NO_PANES
const bool kHasPanes = false;  // thin walls that light goes straight through
#else
const bool kHasPanes = true;
#endif
#ifdef QUINTET_NO_CLEARCOAT
const bool kHasClearcoat = false;
#else
const bool kHasClearcoat = true;
#endif
#ifdef QUINTET_NO_TRIANGLE_LIGHTS
const bool kHasTriangleLights = false;
#else
const bool kHasTriangleLights = true;
#endif
#ifdef QUINTET_NO_SOLID_LIGHTS
const bool kHasSolidLights = false;
#else
const bool kHasSolidLights = true;
#endif
#ifdef QUINTET_NO_PUNCTUAL_LIGHTS
const bool kHasPunctualLights = false;
#else
const bool kHasPunctualLights = true;
#endif
#ifdef QUINTET_NO_ENVIRONMENT
const bool kHasEnvironment = false;  // it is black
#else
const bool kHasEnvironment = true;
#endif
#ifdef QUINTET_NO_VERTEX_COLORS
const bool kHasVertexColors = false;
#else
const bool kHasVertexColors = true;
#endif
#ifdef QUINTET_NO_SEEDS
const bool kHasAlpha = false;  // no any-hit shader decides on a candidate
#else
const bool kHasAlpha = true;
#endif
#ifndef QUINTET_TEXTURE_SLOTS
#define QUINTET_TEXTURE_SLOTS 0xFFFFFFFFu
#endif
const uint kTextureSlots = QUINTET_TEXTURE_SLOTS;  // bit k: a material has texture kTexture… k
// QUINTET_NO_SEEDS, QUINTET_NO_TRANSMITTANCE (shadow rays arrive or do not: neither panes nor alpha blend),
// QUINTET_NO_PROCEDURALS (no solids, no trees), QUINTET_NO_CSG, QUINTET_NO_TORUS, QUINTET_NO_PROCEDURAL_ALPHA and
// QUINTET_NO_PROCEDURAL_PANES are asked by #ifdef: they also take members and stages away.
const bool kHasTransmission = kHasSolidTransmission || kHasThinTransmission;

#endif
