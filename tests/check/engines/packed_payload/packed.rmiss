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

void main() {
  payload.t = -1.0;
  payload.albedo = f16vec3(0.5);
}
