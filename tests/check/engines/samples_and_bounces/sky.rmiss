// SPDX-License-Identifier: Apache-2.0
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
layout(push_constant) uniform Push { vec4 clearColor; } push;

void main() {
  prd.radiance = prd.depth == 0 ? push.clearColor.xyz * 0.8 : vec3(0.01);
}
