// SPDX-License-Identifier: Apache-2.0
struct Payload {
  vec3 radiance;
  vec3 normal;
  uint seed;
};

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 weights;

void main() {
  payload.seed = payload.seed * 747796405u + 2891336453u;
  payload.radiance = vec3(weights, float(payload.seed >> 8) / 16777216.0);
  payload.normal = normalize(gl_ObjectToWorldEXT * vec4(0, 1, 0, 0));
}
