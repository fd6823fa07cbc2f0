// SPDX-License-Identifier: Apache-2.0
// Triangle meshes of simple shapes with normals and texture coordinates (v points down, as in glTF). Triangles are
// counter-clockwise seen from outside.
#ifndef QUINTET_SCENE_GEOMETRY_SHAPES_H
#define QUINTET_SCENE_GEOMETRY_SHAPES_H

#include "scene/model/scene.h"

namespace quintet::scene {

// In the xy plane, centered at the origin, facing +z. uv (0,0) is the upper left corner (-x, +y).
Geometry makeQuad(const vec2& size, const uvec2& segments);
// In the xz plane, centered at the origin, facing +y. uv (0,0) is at (-x, -z).
Geometry makePlane(const vec2& size, const uvec2& segments);
// Centered at the origin. Each of the six faces has its own vertices and shows the whole texture.
Geometry makeCube(const vec3& size, std::uint32_t segments);
// `columns` around the y axis (at least 3), `rows` from pole to pole (at least 2). u runs eastwards from -x through +z,
// v from the north pole (+y) down. Vertices of the seam occur twice, those of a pole once per column.
Geometry makeUvSphere(float radius, std::uint32_t columns, std::uint32_t rows);
// Regular, with corners at distance `radius` from the origin, one of them at +y. Each face shows the lower left half of
// the texture.
Geometry makeTetrahedron(float radius);

}  // namespace quintet::scene
#endif
