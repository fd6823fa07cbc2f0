// SPDX-License-Identifier: Apache-2.0
struct Hit {
  vec3 normal;
  float u;
};

hitAttributeEXT Hit hit;
layout(location = 0) rayPayloadInEXT vec4 color;

void main() {
  vec3 normal = normalize((hit.normal * gl_WorldToObjectEXT).xyz);
  color = vec4(gl_HitKindEXT == 1u ? -normal : normal, hit.u);
}
