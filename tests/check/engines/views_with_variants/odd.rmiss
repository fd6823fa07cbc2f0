// SPDX-License-Identifier: Apache-2.0
struct Radiance {
  vec3 color;
  float distance;
};
layout(location = 0) rayPayloadInEXT Radiance radiance;

void main() { radiance = Radiance(vec3(0.5), -1.0); }
