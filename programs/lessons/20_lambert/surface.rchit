// SPDX-License-Identifier: Apache-2.0
// Mesh and material buffers are found from the custom index of the instance; textures are selected by an index at run
// time.
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include <quintet/material.glsl>
#include "payloads.glsl"

layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 baryCoord;

void main() {
  const vec3 wo = -gl_WorldRayDirectionEXT;
  const Surface surface = fetchSurface(triangleHit(baryCoord, 0u), wo);
  const Shading shading = shadeSurface(surface, wo);
  const float roughness = MaterialArray(frame.materials).at[surface.material].roughness;
  hit = Hit(shading.bsdf.baseColor, surface.position, shading.normal, offsetOrigin(surface, wo), roughness, true);
}
