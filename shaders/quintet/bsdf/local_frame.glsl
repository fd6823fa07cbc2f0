// SPDX-License-Identifier: Apache-2.0
// Orthonormal basis around a normal, to transform directions to a local frame (z is the normal) and back.
#ifndef QUINTET_BSDF_LOCAL_FRAME_GLSL
#define QUINTET_BSDF_LOCAL_FRAME_GLSL

// Columns tangent, bitangent, n: world = basis * local, local = world * basis.
// Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin 2017, "Building an Orthonormal Basis,
// Revisited", listing 3. It is continuous except at n.z = 0 and has no cancellation at n.z = -1.
mat3 localFrame(vec3 n) {
  float s = n.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (s + n.z);
  float b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

#endif
