// SPDX-License-Identifier: Apache-2.0
// The shadow ray is not occluded.
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 1) rayPayloadInEXT ShadowPayload payload;

void main() { payload.visible = 1u; }
