// SPDX-License-Identifier: Apache-2.0
struct RayPayload { vec3 color; int depth; };
layout(location = 0) rayPayloadInEXT RayPayload payload;
void main() { payload.color = vec3(0.2,0.3,0.5); }
