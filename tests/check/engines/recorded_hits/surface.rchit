// SPDX-License-Identifier: Apache-2.0
#extension GL_NV_shader_invocation_reorder : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
struct Payload {
  vec3 color;
  float t;
};

layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT float lit;
hitAttributeEXT vec2 weights;

void main() {
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  hitObjectNV occluder;
  hitObjectTraceRayNV(occluder, tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1,
                      3, position, 0.01, vec3(0, 1, 0), 100.0, 1);
  lit = 0.0;
  hitObjectExecuteShaderNV(occluder, 1);
  payload.color = vec3(weights, lit);
  payload.t = gl_HitTEXT;
}
