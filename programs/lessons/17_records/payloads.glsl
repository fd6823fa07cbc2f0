// SPDX-License-Identifier: Apache-2.0
// One payload per ray type, each at its own location.
struct Radiance {
  vec3 color;
  float free;  // m
};
struct Transmittance {
  vec3 value;
  bool reachedLight;
};
struct Distance { float t; };  // m
