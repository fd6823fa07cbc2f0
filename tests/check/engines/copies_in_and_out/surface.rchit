// SPDX-License-Identifier: Apache-2.0
struct Payload {
  vec4 color;
  vec4 normalAndDistance;
  uint bits;
  uint random;
};
struct ShadowPayload {
  float visibility;
};

struct Attributes {
  vec2 barycentrics;
};
layout(location = 0) rayPayloadInEXT Payload received;
hitAttributeEXT Attributes attributes;

void Hit(inout Payload payload, in Attributes hit) {
  payload.random = payload.random * 747796405u + 1u;
  payload.color = vec4(hit.barycentrics, float(payload.random & 255u) / 255.0, 1);
  payload.normalAndDistance = vec4(0, 1, 0, gl_HitTEXT);
  payload.bits |= 1u;
}

void main() {
  Payload payload = received;
  Attributes hit = attributes;
  Hit(payload, hit);
  received = payload;
}
