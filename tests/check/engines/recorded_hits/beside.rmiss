// SPDX-License-Identifier: Apache-2.0
struct Payload {
  vec3 color;
  float t;
};

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = vec3(gl_RayTmaxEXT / 1e5);
}
