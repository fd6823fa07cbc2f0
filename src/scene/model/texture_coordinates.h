// SPDX-License-Identifier: Apache-2.0
// Textures of meshes from memory need texture coordinates. In files, textures without them are ignored and reported
// (geometry/texture_coordinates.h).
#ifndef QUINTET_SCENE_MODEL_TEXTURE_COORDINATES_H
#define QUINTET_SCENE_MODEL_TEXTURE_COORDINATES_H

#include <cstddef>
#include <string>

#include "scene/model/scene.h"

namespace quintet::scene {

// Throws UsageError with the texture of the material if a geometry of triangles has no coordinates for it. `name`: of the mesh,
// for messages. Geometries whose material does not exist are left to validateMesh().
void requireCoordinates(const Mesh& mesh, const std::string& name, const Scene& scene);

// The same for the geometries of a material that becomes `changed`. Textures that lacked coordinates before can stay.
void requireCoordinates(const Scene& scene, std::size_t material, const Material& changed);

}  // namespace quintet::scene
#endif
