// SPDX-License-Identifier: Apache-2.0
// Features of the scene. The renderer defines QUINTET_NO_… for each feature that no material and no light of the scene
// needs (src/render/scene/scene_features.h). The compiler then removes that code. Results do not change.
#ifndef QUINTET_FEATURES_GLSL
#define QUINTET_FEATURES_GLSL

#include "shared/features.h"

#ifdef QUINTET_SPECIALIZE  // the values are set when the program is known (src/shader/specialization.h)
layout(constant_id = QUINTET_ID_SOLID_TRANSMISSION) const bool kHasSolidTransmission = true;
layout(constant_id = QUINTET_ID_THIN_TRANSMISSION) const bool kHasThinTransmission = true;
layout(constant_id = QUINTET_ID_PANES) const bool kHasPanes = true;
layout(constant_id = QUINTET_ID_CLEARCOAT) const bool kHasClearcoat = true;
layout(constant_id = QUINTET_ID_SHEEN) const bool kHasSheen = true;
layout(constant_id = QUINTET_ID_DIFFUSE_TRANSMISSION) const bool kHasDiffuseTransmission = true;
layout(constant_id = QUINTET_ID_ANISOTROPY) const bool kHasAnisotropy = true;
layout(constant_id = QUINTET_ID_IRIDESCENCE) const bool kHasIridescence = true;
layout(constant_id = QUINTET_ID_DISPERSION) const bool kHasDispersion = true;
layout(constant_id = QUINTET_ID_SCATTERING) const bool kHasScattering = true;
layout(constant_id = QUINTET_ID_NESTED_MEDIA) const bool kHasNestedMedia = true;
layout(constant_id = QUINTET_ID_TRIANGLE_LIGHTS) const bool kHasTriangleLights = true;
layout(constant_id = QUINTET_ID_SOLID_LIGHTS) const bool kHasSolidLights = true;
layout(constant_id = QUINTET_ID_PUNCTUAL_LIGHTS) const bool kHasPunctualLights = true;
layout(constant_id = QUINTET_ID_ENVIRONMENT) const bool kHasEnvironment = true;
layout(constant_id = QUINTET_ID_LIGHT_TREE) const bool kHasLightTree = true;
layout(constant_id = QUINTET_ID_VERTEX_COLORS) const bool kHasVertexColors = true;
layout(constant_id = QUINTET_ID_TEXTURE_SLOTS) const uint kTextureSlots = 0xFFFFFFFFu;
#else
#ifdef QUINTET_NO_SOLID_TRANSMISSION
const bool kHasSolidTransmission = false;  // light enters closed solids
#else
const bool kHasSolidTransmission = true;
#endif
#ifdef QUINTET_NO_THIN_TRANSMISSION
const bool kHasThinTransmission = false;  // thin walls
#else
const bool kHasThinTransmission = true;
#endif
#ifdef QUINTET_NO_PANES
const bool kHasPanes = false;  // smooth thin walls, which transmit light without deflection
#else
const bool kHasPanes = true;
#endif
#ifdef QUINTET_NO_CLEARCOAT
const bool kHasClearcoat = false;
#else
const bool kHasClearcoat = true;
#endif
#ifdef QUINTET_NO_SHEEN
const bool kHasSheen = false;
#else
const bool kHasSheen = true;
#endif
#ifdef QUINTET_NO_DIFFUSE_TRANSMISSION
const bool kHasDiffuseTransmission = false;
#else
const bool kHasDiffuseTransmission = true;
#endif
#ifdef QUINTET_NO_ANISOTROPY
const bool kHasAnisotropy = false;  // the widths of all GGX lobes are equal in all directions
#else
const bool kHasAnisotropy = true;
#endif
#ifdef QUINTET_NO_IRIDESCENCE
const bool kHasIridescence = false;  // thin films
#else
const bool kHasIridescence = true;
#endif
#ifdef QUINTET_NO_DISPERSION
const bool kHasDispersion = false;  // solids refract all colors alike
#else
const bool kHasDispersion = true;
#endif
#ifdef QUINTET_NO_SCATTERING
const bool kHasScattering = false;  // solids only absorb
#else
const bool kHasScattering = true;
#endif
#ifdef QUINTET_NO_NESTED_MEDIA
const bool kHasNestedMedia = false;  // all solids have the same priority: a path is in one solid at a time
#else
const bool kHasNestedMedia = true;
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
const bool kHasEnvironment = false;  // the environment is black
#else
const bool kHasEnvironment = true;
#endif
#ifdef QUINTET_NO_LIGHT_TREE
const bool kHasLightTree = false;  // at most one light, so that the root of the tree is its only leaf
#else
const bool kHasLightTree = true;
#endif
#ifdef QUINTET_NO_VERTEX_COLORS
const bool kHasVertexColors = false;
#else
const bool kHasVertexColors = true;
#endif
#ifndef QUINTET_TEXTURE_SLOTS
#define QUINTET_TEXTURE_SLOTS 0xFFFFFFFFu
#endif
const uint kTextureSlots = QUINTET_TEXTURE_SLOTS;  // bit k: a material has texture kTexture… k
#endif
#ifdef QUINTET_NO_SEEDS
const bool kHasAlpha = false;  // no any-hit shader tests alpha
#else
const bool kHasAlpha = true;
#endif
// These are tested by #ifdef, because they also remove members and stages: QUINTET_NO_SEEDS, QUINTET_NO_TRANSMITTANCE
// (visibility of shadow rays is binary: no panes, no alpha blend), QUINTET_NO_PROCEDURALS (no solids, no CSG trees),
// QUINTET_NO_CSG, QUINTET_NO_TORUS, QUINTET_NO_PROCEDURAL_ALPHA and QUINTET_NO_PROCEDURAL_PANES.
const bool kHasTransmission = kHasSolidTransmission || kHasThinTransmission;

#endif
