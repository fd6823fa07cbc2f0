// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const BoxData box = hitBox();
  const vec3 center = 0.5 * (box.min + box.max);
  const vec3 radii = 0.5 * (box.max - box.min);
  const vec3 position = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT;
  const vec3 gradient = (position - center) / (radii * radii);
  const vec3 normal = normalize(vec3(gradient * gl_WorldToObjectEXT));
  payload.color = 0.5 + 0.5 * normal;
}
