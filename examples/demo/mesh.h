// A triangle mesh while it is being made, and what can be computed from its shape alone: normals with
// creases, tangents, closedness and volume. Counter-clockwise triangles show their front.
#ifndef QUINTET_DEMO_MESH_H
#define QUINTET_DEMO_MESH_H

#include <vector>

#include "base/math.h"

namespace quintet::demo {

// Attributes are empty or as long as `positions`. Lengths are metres.
struct TriangleMesh {
  std::vector<vec3> positions;
  std::vector<vec3> normals;   // unit
  std::vector<vec4> tangents;  // xyz: unit, along +u; w: ±1, bitangent (towards -v) = w · cross(normal, tangent)
  std::vector<vec2> uvs;       // glTF's: (0,0) is the top left of the picture
  std::vector<uvec3> triangles;

  // Moves everything by an affine map; a mirroring one also turns the triangles round.
  void transform(const mat4& m);
  // Adds the other mesh; both must have the same attributes.
  void append(const TriangleMesh& other);
};

// Normals as the mean of the adjoining faces, weighted by the angle of their corner (Thürmer & Wüthrich
// 1998). Vertices at the same position count as one, so texture seams stay invisible. Faces that meet at
// more than `creaseDegrees` keep their edge: the vertex is split. 0 gives flat facets, 180 none.
void computeNormals(TriangleMesh& mesh, float creaseDegrees = 180.0f);

// Tangents along +u (Lengyel 2001), from normals and uvs.
void computeTangents(TriangleMesh& mesh);

// True if every edge is shared by exactly two triangles that run along it in opposite directions.
// Vertices at the same position count as one.
bool isClosed(const TriangleMesh& mesh);

// Signed: positive for a closed mesh whose fronts are outside. Cubic metres.
double volume(const TriangleMesh& mesh);

Bounds3 bounds(const TriangleMesh& mesh);

}  // namespace quintet::demo
#endif
