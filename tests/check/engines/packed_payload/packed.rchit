// SPDX-License-Identifier: Apache-2.0
#extension GL_EXT_shader_explicit_arithmetic_types : require
struct Payload {
  f16vec3 albedo;
  float16_t roughness;
  uint normal;  // packSnorm4x8
  float t;      // negative after a miss
  mat3 frame;
  uint16_t flags;
  float16_t lobes[4];
};

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 weights;

void main() {
  payload.t = gl_HitTEXT;
  payload.albedo = f16vec3(weights, 1);
  payload.roughness = float16_t(0.5);
  payload.normal = packSnorm4x8(vec4(0, 0, 1, 0));
  payload.frame = mat3(1.0);
  payload.flags = uint16_t(gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT ? 1 : 0);
  for (int i = 0; i < 4; ++i) payload.lobes[i] = float16_t(i);
}
