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

layout(location = 0) rayPayloadInEXT ShadowPayload received;

void Miss(inout ShadowPayload payload) { payload.visibility = 1.0; }

void main() {
  ShadowPayload payload = received;
  Miss(payload);
  received = payload;
}
