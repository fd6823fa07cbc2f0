// SPDX-License-Identifier: Apache-2.0
struct Payload {
  vec3 radiance;
  vec3 normal;
  uint seed;
};

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.radiance = vec3(0.5, 0.7, 1.0) * max(gl_WorldRayDirectionEXT.y, 0.1);
}
