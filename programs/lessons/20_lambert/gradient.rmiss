// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_EXT_ray_tracing : require
#include "payloads.glsl"

layout(location = 0) rayPayloadInEXT Hit hit;

void main() {
  const float up = 0.5 + 0.5 * gl_WorldRayDirectionEXT.y;
  hit = Hit(mix(vec3(0.85, 0.8, 0.75), vec3(0.25, 0.45, 0.8), up), vec3(0.0), vec3(0.0), vec3(0.0), 1.0, false);
}
