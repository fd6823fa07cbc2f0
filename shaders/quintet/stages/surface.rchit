// SPDX-License-Identifier: Apache-2.0
// Stores which triangle was hit. The ray generation shader does the shading.
#include <quintet/hit.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;
hitAttributeEXT vec2 baryCoord;

void main() { payload = triangleHit(baryCoord, raySeed(payload)); }
