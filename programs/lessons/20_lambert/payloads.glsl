// SPDX-License-Identifier: Apache-2.0
// The payload of primary rays. Shadow rays have their own payload at location 1.
struct Hit {
  vec3 color;      // base color, or the background
  vec3 position;   // world space
  vec3 normal;     // shading normal on the viewer's side, world space
  vec3 away;       // position, offset from the surface by its error bound
  float roughness; // perceptual
  bool met;
};
