// SPDX-License-Identifier: Apache-2.0
#extension GL_EXT_ray_query : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_nonuniform_qualifier : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 1, binding = 0) uniform sampler2D textures[];
layout(buffer_reference, scalar) readonly buffer Vertices { vec3 at[]; };
layout(buffer_reference, scalar) readonly buffer Indices { uvec3 at[]; };
struct Material {
  vec4 color;
  int texture;
};
layout(buffer_reference, scalar) readonly buffer Materials { Material at[]; };
layout(shaderRecordEXT, scalar) buffer Record {
  Vertices vertices;
  Indices indices;
  Materials materials;
  uint material;
} record;
layout(location = 0) rayPayloadInEXT vec4 color;
hitAttributeEXT vec2 weights;

float visibility(vec3 origin, vec3 direction) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT, 0xFF, origin, 0.0,
                        direction, 1e3);
  while (rayQueryProceedEXT(query)) {
  }
  return rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT ? 1.0 : 0.2;
}

void main() {
  uvec3 i = record.indices.at[gl_PrimitiveID];
  vec3 a = record.vertices.at[i.x], b = record.vertices.at[i.y], c = record.vertices.at[i.z];
  vec3 all = vec3(1.0 - weights.x - weights.y, weights);
  vec3 position = gl_ObjectToWorldEXT * vec4(a * all.x + b * all.y + c * all.z, 1);
  vec3 normal = normalize((cross(b - a, c - a) * gl_WorldToObjectEXT).xyz);
  Material material = record.materials.at[record.material];
  vec4 base = material.color;
  if (material.texture >= 0) base *= textureLod(textures[nonuniformEXT(material.texture)], weights, 0.0);
  color = vec4(base.rgb * visibility(position + normal * 1e-3, vec3(0, 1, 0)), 1);
}
