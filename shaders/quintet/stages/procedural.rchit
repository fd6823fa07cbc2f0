// SPDX-License-Identifier: Apache-2.0
// Stores which solid was hit, also in a CSG tree. The ray generation shader does the shading.
#include <quintet/features.glsl>
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;

#ifdef QUINTET_NO_PROCEDURALS
void main() {}
#else
#include <quintet/procedural/hit.glsl>
void main() { payload = solidHit(raySeed(payload)); }
#endif
