// SPDX-License-Identifier: Apache-2.0
// Stores which box was hit.
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;

void main() { payload = hitOf(hitGeometry(), raySeed(payload)); }
