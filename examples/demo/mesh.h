// SPDX-License-Identifier: Apache-2.0
// A triangle mesh under construction, and properties of its shape: normals with creases, tangents, closedness, volume.
// The front of a triangle is counter-clockwise.
#ifndef QUINTET_DEMO_MESH_H
#define QUINTET_DEMO_MESH_H

#include <vector>

#include "base/math.h"

namespace quintet::demo {

// Attributes are empty or have one element per position. Lengths are in meters.
struct TriangleMesh {
  std::vector<vec3> positions;
  std::vector<vec3> normals;   // unit
  std::vector<vec4> tangents;  // xyz: unit, along +u; w: ±1, bitangent (towards -v) = w · cross(normal, tangent)
  std::vector<vec2> uvs;       // as in glTF: (0,0) is the upper left corner of the image
  std::vector<uvec3> triangles;

  // Applies an affine transform. Mirroring also reverses the triangles.
  void transform(const mat4& m);
  // Appends a mesh with the same attributes.
  void append(const TriangleMesh& other);
};

// Sets the normals to the mean of the adjacent faces, weighted by the corner angle (Thürmer & Wüthrich 1998). Vertices
// at the same position count as one, so that texture seams are invisible. An edge between faces at more than
// `creaseDegrees` is kept: its vertices are split. 0 gives flat facets, 180 smooth edges only.
void computeNormals(TriangleMesh& mesh, float creaseDegrees = 180.0f);

// Sets tangents along +u (Lengyel 2001) from normals and uvs.
void computeTangents(TriangleMesh& mesh);

// True if every edge belongs to exactly two triangles, which traverse it in opposite directions. Vertices at the same
// position count as one.
bool isClosed(const TriangleMesh& mesh);

// Signed volume in cubic meters: positive for a closed mesh with the front outside.
double volume(const TriangleMesh& mesh);

Bounds3 bounds(const TriangleMesh& mesh);

}  // namespace quintet::demo
#endif
