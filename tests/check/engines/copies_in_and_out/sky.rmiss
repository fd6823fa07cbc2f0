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

layout(location = 0) rayPayloadInEXT Payload received;

void Miss(inout Payload payload) { payload.color = vec4(0.5); }

void main() {
  Payload payload = received;
  Miss(payload);
  received = payload;
}
