// Triangle meshes of simple shapes, with normals and texture coordinates (v down, as in glTF). Counter-clockwise seen
// from outside.
#ifndef QUINTET_SCENE_SHAPES_H
#define QUINTET_SCENE_SHAPES_H

#include "scene/scene.h"

namespace quintet::scene {

// In the xy plane about the origin, facing +z; uv (0,0) is its upper left corner (-x, +y).
Geometry makeQuad(const vec2& size, const uvec2& segments);
// In the xz plane, facing +y; uv (0,0) is at (-x, -z).
Geometry makePlane(const vec2& size, const uvec2& segments);
// Six faces with vertices of their own, each with the whole texture.
Geometry makeCube(const vec3& size, std::uint32_t segments);
// Columns around y (at least 3), rows from pole to pole (at least 2). u runs eastwards from -x through +z, v from the
// north pole (+y) down. The seam's vertices are there twice, a pole's once per column.
Geometry makeUvSphere(float radius, std::uint32_t columns, std::uint32_t rows);
// Regular, its corners at `radius` from the origin, one up; each face has the lower left half of the texture.
Geometry makeTetrahedron(float radius);

}  // namespace quintet::scene
#endif
