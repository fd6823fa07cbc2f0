// SPDX-License-Identifier: Apache-2.0
// The ray missed the scene: t is negative.
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;

void main() { payload.t = -1.0; }
