// SPDX-License-Identifier: Apache-2.0
layout(location = 0) rayPayloadInEXT vec3 sky;

void main() {
  sky = vec3(0.5, 0.7, 1.0) * gl_WorldRayDirectionEXT.y;
}
