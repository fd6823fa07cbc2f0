// SPDX-License-Identifier: Apache-2.0
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba16f) uniform image2D result;
struct Payload {
  vec3 radiance;
  uint seed;
  vec3 origin;
  vec3 direction;
  vec3 attenuation;
  int depth;
  int done;
};

layout(location = 0) rayPayloadInEXT Payload prd;
layout(location = 1) rayPayloadEXT bool isShadowed;
hitAttributeEXT vec2 attribs;

layout(buffer_reference, scalar) readonly buffer Vertices { vec3 at[]; };
layout(buffer_reference, scalar) readonly buffer Indices { uvec3 at[]; };
struct Object {
  uint64_t vertices, indices;
};
layout(set = 1, binding = 1, scalar) readonly buffer Objects { Object at[]; } objects;

void main() {
  Object object = objects.at[gl_InstanceCustomIndexEXT];
  Vertices vertices = Vertices(object.vertices);
  uvec3 i = Indices(object.indices).at[gl_PrimitiveID];
  vec3 a = vertices.at[i.x], b = vertices.at[i.y], c = vertices.at[i.z];
  vec3 weights = vec3(1.0 - attribs.x - attribs.y, attribs);
  vec3 position = gl_ObjectToWorldEXT * vec4(a * weights.x + b * weights.y + c * weights.z, 1);
  vec3 normal = normalize((cross(b - a, c - a) * gl_WorldToObjectEXT).xyz);
  vec3 toLight = normalize(vec3(1, 2, 3));
  float light = 0.3;
  if (dot(normal, toLight) > 0.0) {
    vec3 origin = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
    uint flags = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT;
    isShadowed = true;
    traceRayEXT(tlas, flags, 0xFF, 0, 0, 1, origin, 0.001, toLight, 1e5, 1);
    if (!isShadowed) light = 1.0;
  }
  prd.radiance = vec3(light);
  prd.attenuation *= 0.5;
  prd.done = 0;
  prd.origin = position;
  prd.direction = reflect(gl_WorldRayDirectionEXT, normal);
}
