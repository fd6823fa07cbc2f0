// Tangent frames for normal maps where the file has none.
// E. Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh", 2001 (Foundations of Game
// Engine Development 2, section 7.5): per-triangle dP/du, here weighted by the corner's angle, summed
// per vertex and made perpendicular to the normal. MikkTSpace, which glTF recommends, also weights by the
// angle, but sums only within smooth groups of its own welding: the frames agree on smooth surfaces.
#ifndef QUINTET_SCENE_TANGENTS_H
#define QUINTET_SCENE_TANGENTS_H

#include "scene/scene.h"

namespace quintet::scene {

// Fills geometry.tangents for the texture coordinates of `use` (its set and its transform). Needs normals
// and that set; without either it does nothing. A vertex whose triangles disagree about the handedness of
// the mapping (a mirrored seam) is duplicated.
void generateTangents(Geometry&, const TextureUse& use);

// What a material's normal map needs, if the geometry lacks it; the clear coat's map shares the frame of the base's.
void addTangents(Geometry&, const Material&);

// Three vertices of its own for each triangle, with the face normal: what flat shading and a normal map need together.
void splitIntoFlatTriangles(Geometry&);

// u' = translation · rotation · scale · u (KHR_texture_transform).
vec2 transformUv(const TextureUse& use, const vec2& uv);

}  // namespace quintet::scene
#endif
